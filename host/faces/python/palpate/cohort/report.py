# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The page about a cohort that a clinician reads: one file, no network."""
from __future__ import annotations

import html
import io
import json
import math
import os
import pathlib
import shutil
import tempfile

import numpy as np

from .errors import OUTPUT_FAILED, CohortError
from .study import Study, p_text

STYLE = """body{font:16px/1.5 system-ui,sans-serif;color:#1a1f26;max-width:60rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.6rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin-top:2.2rem}table{border-collapse:collapse;font-size:.9rem}
td,th{padding:.25rem .7rem;white-space:nowrap;border-bottom:1px solid #d9dee5;text-align:right}td:first-child,th:first-child{text-align:left}
th{font-weight:600;border-bottom:2px solid #8a94a3}.note{background:#fff4dd;padding:.5rem .9rem;border-left:4px solid #d99a1c}
.lead{font-size:1.05rem}figure{margin:1rem 0}svg{max-width:100%;height:auto}.small{color:#5a6472;font-size:.85rem}"""
POINT, BOX = "#1f5fa8", "#c8d6e8"


def number(value, digits: int = 3) -> str:
    """As people read it, `digits` significant ones; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return "–"
    return f"{value:.{max(0, digits - 1 - math.floor(math.log10(abs(value))))}f}" if value else "0"


def table(header, rows) -> str:
    cells = lambda tag, row: "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in row)
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table><thead><tr>{cells('th', header)}</tr></thead><tbody>{body}</tbody></table>"


def stiffness_plot(study: Study) -> str:
    """Every patient as a point with its 95 % interval; boxes (quartiles, median) of classes with four patients or more."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    chosen = study.patients.loc[study.tested] if study.tested else study.patients
    variable = study.variable
    x = variable.values if variable else np.arange(len(chosen), dtype=float)
    figure, axes = pyplot.subplots(figsize=(8, 4.2))
    shown = x.astype(float).copy()
    if variable and variable.classes:
        for value in variable.classes:
            members = np.flatnonzero(x == value)
            shown[members] += np.linspace(-0.22, 0.22, len(members)) if len(members) > 1 else 0
            if len(members) >= 4:
                axes.boxplot([chosen["random_effects_kpa"].to_numpy()[members]], positions=[value], widths=0.6, manage_ticks=False,
                             patch_artist=True, showfliers=False, boxprops={"facecolor": BOX, "edgecolor": "#7d8da1"},
                             medianprops={"color": "#33475f"}, whiskerprops={"color": "#7d8da1"}, capprops={"color": "#7d8da1"})
        axes.set_xticks(list(variable.classes), list(variable.classes.values()))
    elif not variable:
        axes.set_xticks(x, list(chosen.index), rotation=45 if len(x) > 8 else 0)
    kpa = chosen["random_effects_kpa"].to_numpy()
    error = np.abs(np.stack([kpa - chosen["random_effects_low_kpa"], chosen["random_effects_high_kpa"] - kpa]))
    axes.errorbar(shown, kpa, yerr=error, fmt="o", color=POINT, ecolor=POINT, elinewidth=1.2, markersize=5, zorder=3)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axes.tick_params(axis="y", which="minor", labelsize=7)
    axes.set_ylabel(f"Young's modulus of {study.pairs.region or 'the organ'}, kPa")
    axes.set_xlabel(variable.name if variable else "patient")
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", which="both", color="#e6eaef", zorder=0)
    axes.set_axisbelow(True)
    figure.tight_layout()
    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "palpate"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    svg = text.getvalue()
    return f"<figure>{svg[svg.index('<svg'):]}</figure>"


def flow_rows(study: Study):
    counts = study.pairs.excluded["reason"].value_counts()
    yield "pairs in the table", study.pairs.total
    for reason, count in counts.items():
        yield f"− {reason}", count
    yield f"= in the statistics, of {len(study.patients)} patients", len(study.pairs.used)


def patient_rows(study: Study):
    for participant, row in study.patients.iterrows():
        yield (participant, int(row["pairs"]), int(row["weak"]), f"{number(row['mean_kpa'])} ± {number(row['sd_kpa'], 2)}",
               f"{number(row['random_effects_kpa'])} [{number(row['random_effects_low_kpa'])}, {number(row['random_effects_high_kpa'])}]",
               f"{number(row['joint_kpa'])} [{number(row['joint_low_kpa'])}, {number(row['joint_high_kpa'])}]")


def correlation_rows(study: Study):
    for what, found in study.correlations:
        exact = "–" if math.isnan(found.exact_p) else (
            p_text(found.exact_p) + (f" (all {found.arrangements:,} orders)" if found.is_exact
                                     else f" ({found.arrangements:,} random orders, seed {found.seed})"))
        yield (f"{found.test}, {what}", f"{found.symbol} = {found.value:.3f}", f"{found.interval[0]:.2f} to {found.interval[1]:.2f}",
               p_text(found.p), exact, found.n)


def tests_html(study: Study) -> str:
    if not study.correlations:
        return ""
    name = html.escape(study.variable.name)
    parts = [f"<h2>Against {name}</h2>",
             table(["test", "coefficient", "95 % (bootstrap)", "p", "p by permutation", "n (patients)"],
                   correlation_rows(study))]
    r = study.regression
    low, high = r.step_percent[1:]
    parts.append(f"<p>Weighted regression of ln E: a step of {name} goes with {r.step_percent[0]:+.0f} % of stiffness "
                 f"(95 %: {low:+.0f} to {high:+.0f} %; t test, p {p_text(r.p) if r.p < 1e-4 else '= ' + p_text(r.p)}, n = {r.n} patients). Neither the variable nor their own errors explain a "
                 f"scatter of {100 * math.expm1(r.scatter):.0f} % between patients.</p>")
    if study.discriminations:
        parts.append(table(["told apart by stiffness", "area under the ROC curve", "95 % (bootstrap)",
                            "p (Mann and Whitney)", "n (below, above)"],
                           [(d.classes, f"{d.auc:.2f}", f"{d.interval[0]:.2f} to {d.interval[1]:.2f}", p_text(d.p),
                             f"{d.num_low}, {d.num_high}") for d in study.discriminations]))
    return "".join(parts)


def scans_html(study: Study) -> str:
    s = study.scans
    if s is None:
        return ""
    return ("<h2>Between scans of one patient</h2>"
            f"<p>Mixed model of ln E, {s.num_patients} patients, {s.num_pairs} pairs: sd between patients {s.between_sd:.3f}, within a patient "
            f"{s.within_sd:.3f} ({s.within_interval[0]:.3f} to {s.within_interval[1]:.3f}). Intraclass correlation {s.icc:.2f} "
            f"({s.icc_interval[0]:.2f} to {s.icc_interval[1]:.2f}). Two scans of one patient differ by less than "
            f"{s.less_percent:.0f} % or {s.more_percent:+.0f} % in 95 of 100 cases (2.77 times the sd within a patient).</p>")


def page(study: Study, title: str) -> str:
    notes = "".join(f'<p class="note">{html.escape(note)}</p>' for note in study.notes)
    if study.sd_reference == 0:
        notes += ('<p class="note">The error that all pairs of a patient share through their one reference is ' + html.escape(study.reference_source) +
                  ". Give it with --sd-reference, or add pairs with each target as reference.</p>")
    shared = (f"All pairs of a reference share an error of {study.sd_reference:.3f} in ln E ({html.escape(study.reference_source)}); it is in the "
              "intervals." if study.sd_reference else "")
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'"><style>{STYLE}</style></head><body>
<h1>{html.escape(title)}</h1>
<p class="lead">{len(study.pairs.used)} of {study.pairs.total} image pairs of {len(study.patients)} patients say something of the stiffness of
{html.escape(study.pairs.region or "the organ")}. {shared}</p>
{notes}
{stiffness_plot(study)}
<h2>Patients</h2>
{table(["patient", "pairs", "of them weak", "mean ± sd, kPa", "random effects [95 %], kPa", "joint likelihood [95 %], kPa"], patient_rows(study))}
<p class="small">Mean and sd of the pairs as publications print them; random effects (Paule and Mandel) weigh pairs by their intervals and allow them to
differ; the joint likelihood takes all pairs for one stiffness. The points above are random effects.</p>
{tests_html(study)}
{scans_html(study)}
<h2>What entered</h2>
{table(["", "pairs"], flow_rows(study))}
<p class="small">A stiffness that is not identifiable never enters: it is the prior, not the patient. The number n of every test is of patients; the bootstrap draws patients.</p>
</body></html>
"""


def figures(study: Study) -> dict:
    """What the page says, for programs; NaN becomes null."""
    def plain(value):
        if isinstance(value, float):
            return value if math.isfinite(value) else None
        if isinstance(value, (list, tuple)):
            return [plain(v) for v in value]
        if isinstance(value, dict):
            return {str(k): plain(v) for k, v in value.items()}
        return value.item() if isinstance(value, np.generic) else value

    return {key: plain(value) for key, value in {
        "region": study.pairs.region, "pairs": study.pairs.total, "pairs_used": len(study.pairs.used), "patients": len(study.patients),
        "excluded": study.pairs.excluded["reason"].value_counts().to_dict(), "sd_reference": study.sd_reference,
        "sd_reference_source": study.reference_source, "variable": study.variable.name if study.variable else None,
        "correlations": [{"of": what, **vars(found)} for what, found in study.correlations],
        "regression": vars(study.regression) if study.regression else None,
        "discrimination": [vars(d) for d in study.discriminations], "scans": vars(study.scans) if study.scans else None,
        "notes": study.notes}.items()}


def write_report(study: Study, folder, title: str = "Stiffness of a cohort") -> None:
    """index.html, patients.tsv, statistics.json in a new folder that is there whole or not at all.

    Raises CohortError where the folder is there already or cannot be written.
    """
    folder = pathlib.Path(folder)
    if folder.exists():
        raise CohortError(f"{folder} is there already; take another --out, or remove it", OUTPUT_FAILED)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = pathlib.Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        try:
            (temporary / "index.html").write_text(page(study, title), encoding="utf-8")
            study.patients.to_csv(temporary / "patients.tsv", sep="\t")
            (temporary / "statistics.json").write_text(json.dumps(figures(study), indent=2) + "\n", encoding="utf-8")
            temporary.chmod(0o755)
            os.rename(temporary, folder)
        except BaseException:
            shutil.rmtree(temporary, ignore_errors=True)
            raise
    except OSError as error:
        raise CohortError(f"{folder} cannot be written: {error.strerror}; choose another --out", OUTPUT_FAILED) from error
