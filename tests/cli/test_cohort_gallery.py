# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The gallery of a cohort in a browser: keys, focus, names for screen readers, filters, downloads."""
import html
import json
import os
import re
import shutil
import subprocess

import pytest

from tests.cli.test_cohort import plan, rows_of, run
from tests.conftest import run_palpate

IDS = ("alpha", "beta", "gamma", "fail-4")
WITH_FUNCTIONS = """
const told = {};
const key = async name => {
  document.activeElement.dispatchEvent(new KeyboardEvent("keydown", {key: name, bubbles: true, cancelable: true}));
  await new Promise(done => setTimeout(done, 50));
};
const type = async (id, text) => {
  document.getElementById(id).value = text;
  document.getElementById(id).dispatchEvent(new Event("change"));
  await new Promise(done => setTimeout(done, 50));
};
const chosen = () => [...document.querySelectorAll("[aria-current]")].map(card => card.querySelector("h3").textContent.trim());
const shown = () => [...document.querySelectorAll(".case h3")].map(title => title.textContent.trim());
const focus = () => document.activeElement.id;
const blobs = [];
URL.createObjectURL = blob => { blobs.push(blob); return "#"; };
HTMLAnchorElement.prototype.click = function () { (told.files ||= []).push(this.download); };
(async () => {
  for (let tries = 0; tries < 100 && !document.querySelector(".case"); ++tries) await new Promise(done => setTimeout(done, 50));
  %s
})().catch(error => { told.error = String(error); }).then(async () => {
  told.texts = await Promise.all(blobs.map(blob => blob.text()));
  const place = document.createElement("pre");
  place.id = "told";
  place.textContent = JSON.stringify(told);
  document.body.append(place);
});
"""


@pytest.fixture(scope="module")
def collected(tmp_path_factory):
    """Three cases with a result and one without, of four patients: x0 to x3."""
    cohort = plan(tmp_path_factory.mktemp("gallery"), ids=IDS, seconds=0)
    assert run(cohort).returncode == 7
    assert run_palpate("cohort", "collect", cohort).returncode == 0
    return cohort


def in_browser(cohort, script, anchor=""):
    """What the script leaves in `told`, after the page has come up; `blobs` are downloads."""
    if shutil.which("chromium") is None:
        pytest.skip("chromium is not installed, so the gallery cannot be opened")
    page = (cohort / "gallery.html").read_text()
    at = page.rindex("</body>")
    opened = cohort / "opened.html"
    opened.write_text(page[:at] + f"<script>{WITH_FUNCTIONS % script}</script>" + page[at:])
    finished = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                               "--virtual-time-budget=20000", "--dump-dom", f"file://{opened}{anchor}"], text=True, timeout=200,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env={**os.environ, "HOME": str(cohort)})
    found = re.search(r'<pre id="told">(.*?)</pre>', finished.stdout, re.DOTALL)
    assert found, finished.stdout[-2000:]
    told = json.loads(html.unescape(found.group(1)))
    assert "error" not in told, told["error"]
    return told


def test_keys_choose_rate_and_leave_the_filter(collected):
    told = in_browser(collected, """
      told.all = shown(); told.first = chosen(); told.focus = [focus()];
      await key("ArrowRight"); told.second = chosen(); told.focus.push(focus());
      await key("ArrowLeft"); told.back = chosen();
      await key("ArrowLeft"); told.before = chosen();
      await key("ArrowDown"); await key("ArrowDown"); await key("ArrowDown"); await key("ArrowDown"); told.last = chosen();
      await key("ArrowUp"); await key("ArrowUp"); await key("ArrowUp"); await key("ArrowUp");
      await key("r"); told.rated = document.getElementById("c0").dataset.rating; told.next = chosen();
      await key("0"); await key("Enter"); told.large = document.getElementById("c1").classList.contains("large");
      await key("f"); told.focus.push(focus()); await key("r"); told.typed = document.getElementById("c1").dataset.rating;
      await key("Escape"); told.focus.push(focus());
      await key("/"); told.focus.push(focus()); await key("Escape"); told.focus.push(focus());
      await key("u"); told.unsure = document.getElementById("c1").dataset.rating;
    """)
    assert len(told["all"]) == 4 and "fail-4" in told["all"][3]
    assert [told["first"], told["second"]] == [[told["all"][0]], [told["all"][1]]]
    assert told["back"] == told["first"] == told["before"] and told["last"] == [told["all"][3]]
    assert told["rated"] == "reject" and told["next"] == told["second"] and told["large"]
    assert told["focus"] == ["c0", "c1", "flag", "c1", "find", "c1"]
    assert told["typed"] == "" and told["unsure"] == "unsure"


def test_a_key_that_is_held_down_rates_nothing_further(collected):
    told = in_browser(collected, """
      for (let k = 0; k < 3; ++k)
        document.activeElement.dispatchEvent(new KeyboardEvent("keydown", {key: "a", bubbles: true, repeat: k > 0}));
      told.rated = [...document.querySelectorAll(".case")].map(card => card.dataset.rating);
    """)
    assert told["rated"] == ["accept", "", "", ""]


def test_the_table_has_no_formulas_and_no_open_quotes(collected):
    told = in_browser(collected, """
      const row = (await fileOf(0))[0];
      row[REGIONS] = [["=1+1", "weak", 20, 10, 40], ['a "ball"', "weak", 20, 10, 40]];
      row[SENTENCE] = "-a\\tb";
      await key("t");
    """)
    table, = told["texts"]
    first, second = [line.split("\t") for line in table.splitlines()[1:3]]
    assert first[6] == "'=1+1" and second[6] == '"a ""ball"""' and first[-1] == "'-a b" and first[8] == "20"


def test_filters_look_at_all_pages_and_the_table_has_what_they_show(collected):
    told = in_browser(collected, """
      await key("ArrowRight"); await key("a");
      await type("find", "X2"); told.found = shown(); await key("t");
      await type("find", "nobody"); told.nobody = shown(); told.nothing = !document.getElementById("nothing").hidden;
      await type("find", ""); await type("show", "accept"); told.accepted = shown();
      await type("show", ""); await type("flag", document.getElementById("flag").options[1].value);
      told.flagged = shown(); told.flag = document.getElementById("flag").options[1].text;
      await type("flag", ""); told.all = shown(); await key("t"); await key("d");
    """)
    assert told["found"] == ["x2 · gamma target-01"] and told["nobody"] == [] and told["nothing"]
    assert told["accepted"] == [told["all"][1]] and len(told["all"]) == 4
    assert told["flag"] == "failed (1)" and told["flagged"] == [told["all"][3]]
    assert told["files"] == ["gallery.tsv", "gallery.tsv", "ratings.tsv"]
    few, table, ratings = ([line.split("\t") for line in text.splitlines()] for text in told["texts"])
    assert len(few) == 2 and few[1][:2] == ["x2", "gamma"] and {len(row) for row in table} == {13}
    rows = [dict(zip(table[0], row)) for row in table[1:]]
    collected_rows = {row["case_id"]: row for row in rows_of(collected / "pairs.tsv")}
    assert {row["case_id"] for row in rows} == set(collected_rows)
    for row in rows:
        assert row["e_kpa"] == collected_rows[row["case_id"]]["e_kpa"]
    assert [row["rating"] for row in rows] == ["", "accept", "", ""] and "asked to" in rows[3]["failure"]
    assert len(ratings) == 2 and ratings[1][1:3] == [rows[1]["case_id"], "accept"]


def test_a_flag_of_the_cohorts_page_opens_its_cases(collected):
    anchor, = re.findall(r"href='gallery.html(#flag-\d+)'>failed<", (collected / "index.html").read_text())
    told = in_browser(collected, "await key('x'); told.shown = shown(); told.flag = document.getElementById('flag').value;", anchor)
    assert len(told["shown"]) == 1 and "fail-4" in told["shown"][0] and anchor == "#flag-" + told["flag"]


def test_everything_has_a_name_and_one_card_is_in_the_order_of_tab(collected):
    told = in_browser(collected, """
      const nameOf = thing => thing.getAttribute("aria-label") || thing.getAttribute("alt") ||
        (thing.getAttribute("aria-labelledby") && document.getElementById(thing.getAttribute("aria-labelledby")).textContent) ||
        (thing.labels && thing.labels.length && thing.labels[0].textContent.trim()) || thing.textContent.trim();
      const all = [...document.querySelectorAll("button, input, select, a, img, article, nav, [role=img], [role=group]")];
      told.number = all.length;
      told.nameless = all.filter(thing => !nameOf(thing) || nameOf(thing).length < 2).map(thing => thing.outerHTML);
      told.order = [...document.querySelectorAll("#cards *")].filter(thing => thing.tabIndex >= 0).map(thing => thing.id || thing.textContent);
      await key("ArrowRight");
      told.later = [...document.querySelectorAll("#cards *")].filter(thing => thing.tabIndex >= 0).map(thing => thing.id || thing.textContent);
      told.bar = document.querySelector(".bar-of-e").getAttribute("aria-label");
      told.status = document.querySelector("[role=status]").textContent;
    """)
    assert told["number"] > 20 and told["nameless"] == []
    assert told["order"] == ["c0", "Accept", "Reject", "Unsure"] and told["later"] == ["c1", "Accept", "Reject", "Unsure"]
    assert told["bar"] == "test stub: 50.0 kPa (41.0 to 61.0), recovered" and told["status"] == "this page: none rated"
