# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What `palpate recover`, `phantom`, `simulate`, `study` and `springs` do, by name.

    palpate.run("springs", force_mn=10, end_mm=[3.0, 3.1], joint_mm=[1.0])
    palpate.applications.springs(force_mn=10, end_mm=3.0)       # the same, with help() of its own

Names, types and meanings of the keywords come from the library: `palpate describe` prints them.
"""
from __future__ import annotations

import inspect
import json
import os
import pathlib
from typing import Any, Callable, Dict, List, Optional, Sequence, Union

from . import _core
from .solver import Progress

_TYPES = {"flag": bool, "integer": int, "number": float, "text": str, "choice": str}


class Outcome(Dict[str, Any]):
    """The result as `result.json` holds it; `status` is the exit code of the command line: 0, 7 if
    the search did not converge, or that of the first failure among several cases."""

    status: int = 0

    @property
    def converged(self) -> bool:
        return self.status == 0


def tables() -> Dict[str, Dict[str, Any]]:
    """By name: {"name", "summary", "options": [{"name", "kind", "meaning", "allowed", ...}]}."""
    return {one["name"]: one for one in json.loads(_core.applications())["applications"]}


def _text(value: str) -> str:
    """As a string of TOML, whose escapes are JSON's but for the character DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml(value: Any) -> str:
    if isinstance(value, (bool, str)):
        return _text(value) if isinstance(value, str) else str(value).lower()
    if isinstance(value, os.PathLike):
        return _text(os.fspath(value))
    if hasattr(value, "tolist"):  # NumPy's arrays and numbers
        return _toml(value.tolist())
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    raise TypeError(f"an option is a number, a text, a path, True, False or a list, not {value!r}")


def run(application: str, progress: Progress = None, **options: Any) -> Outcome:
    """Runs an application; options of its table are keywords; None and empty lists are as good as none.

    progress  called with (stage, fraction, message); False cancels

    Raises PalpateError, whose `status` is the exit code of the command line (11: cancelled).
    """
    program = pathlib.Path(__file__).parent / "bin" / "palpate-mesh"
    known = [option["name"] for option in tables().get(application, {}).get("options", [])]
    if "mesh_program" in known and options.get("mesh_program") is None and program.exists():
        options["mesh_program"] = program
    settings = "".join(f"{_text(name)} = {_toml(value)}\n" for name, value in options.items()
                       if value is not None and not (isinstance(value, (list, tuple)) and not value))
    status, result = _core.run(application, settings, progress)
    outcome = Outcome(json.loads(result))
    outcome.status = status
    return outcome


def _type_of(option: Dict[str, Any]) -> Any:
    one = _TYPES.get(option["kind"], Union[str, "os.PathLike[str]"])
    return Union[one, Sequence[one]] if "most_values" in option else one


def _parameter(option: Dict[str, Any]) -> inspect.Parameter:
    required = option["required"]
    kind = _type_of(option)
    return inspect.Parameter(option["name"], inspect.Parameter.KEYWORD_ONLY,
                             default=inspect.Parameter.empty if required else option["default"],
                             annotation=kind if required else Optional[kind])


def _function(table: Dict[str, Any]) -> Callable[..., Outcome]:
    def call(**options: Any) -> Outcome:
        return run(table["name"], **options)

    options: List[Dict[str, Any]] = sorted(table["options"], key=lambda one: not one["required"])
    lines = [f"    {one['name']}: {one['meaning']}; {one['allowed']}" for one in options]
    call.__name__ = call.__qualname__ = table["name"]
    call.__doc__ = "\n".join([table["summary"] + ".", "", *lines, "",
                              "    progress: called with (stage, fraction, message); False cancels"])
    progress = inspect.Parameter("progress", inspect.Parameter.KEYWORD_ONLY, default=None,
                                 annotation=Progress)
    call.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [*map(_parameter, options), progress], return_annotation=Outcome)
    return call


globals().update({name: _function(table) for name, table in tables().items()})
