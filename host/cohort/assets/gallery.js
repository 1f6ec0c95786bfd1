// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Needs GALLERY: cases, page, file, flags, low, high. Rows come from gallery/rows-NNNN.js, each
// [folder, target, session, key, rating, [[region, verdict, E, low, high]], seconds, sentence, flags].
const [FOLDER, TARGET, SESSION, KEY, RATING, REGIONS, SECONDS, SENTENCE, FLAGS] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
const RATINGS = ["accept", "reject", "unsure"];
const pages = Math.max(1, Math.ceil(GALLERY.cases / GALLERY.page));
const byId = id => document.getElementById(id);
const files = new Map();
const memory = "palpate ratings " + location.pathname;
let rated = {}, page = 1, rows = [], here = -1;

try { rated = JSON.parse(localStorage.getItem(memory)) || {}; } catch { rated = {}; }

function galleryRows(number, list) { files.get(number).resolve(list); }

function fileOf(number) {
  if (files.has(number)) return files.get(number).promise;
  const file = {};
  file.promise = new Promise((resolve, reject) => {
    file.resolve = resolve;
    const script = document.createElement("script");
    script.src = "gallery/rows-" + String(number).padStart(4, "0") + ".js";
    script.onerror = () => reject(new Error(script.src));
    document.head.append(script);
  });
  files.set(number, file);
  return file.promise;
}

function element(name, words, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(words || {})) {
    if (key in made && key !== "style" && key !== "loading") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const ratingOf = row => {
  const own = rated[row[FOLDER]];
  return own && own[1] === row[KEY] ? own[0] : row[RATING];
};

const number = value => value >= 100 ? value.toFixed(0) : value.toPrecision(3);

function xOf(value) {
  const share = Math.log(value / GALLERY.low) / Math.log(GALLERY.high / GALLERY.low || 2);
  return 400 * Math.min(1, Math.max(0, Number.isFinite(share) ? share : .5));
}

function barOf(region) {
  const [name, verdict, e, low, high] = region;
  const known = e !== null;
  const text = element("div", {className: "e"}, element("span", {}, name), element("span", {},
    known ? number(e) + " kPa (" + number(low) + " to " + number(high) + "), " + verdict : verdict));
  if (!GALLERY.low || low === null) return [text];
  const colour = !known ? "var(--line)" : verdict === "weak" ? "var(--weak)" : "var(--accent)";
  const holder = element("div");
  holder.innerHTML = "<svg class='bar-of-e' viewBox='0 0 400 30' preserveAspectRatio='none' role='img'>" +
    "<path d='M0 8H400' stroke='var(--line)'/>" +
    "<path d='M" + xOf(low) + " 8H" + xOf(high) + "' stroke='" + colour + "' stroke-width='5'/>" +
    (known ? "<circle cx='" + xOf(e) + "' cy='8' r='5' fill='" + colour + "'/>" : "") +
    "<text x='0' y='27'>" + number(GALLERY.low) + "</text><text x='400' y='27' text-anchor='end'>" +
    number(GALLERY.high) + " kPa</text></svg>";
  return [text, holder.firstChild];
}

function chipsOf(row) {
  const grave = 7;  // flags before that are red
  return GALLERY.flags.filter((_, k) => row[FLAGS] >> k & 1).map(name => element("span",
    {className: "chip " + (GALLERY.flags.indexOf(name) < grave ? "bad" : "weak")}, name));
}

function pictureOf(row) {
  const without = text => element("div", {className: "none"}, text);
  if (row[FLAGS] & 1) return without("Failed: " + row[SENTENCE]);
  const picture = element("img", {loading: "lazy", alt: "three slices with contours", src: "cases/" + row[FOLDER] + "/card.svg"});
  picture.onerror = () => picture.replaceWith(without("There is no picture of this case."));
  return picture;
}

function cardOf(row, k) {
  const [, patient, name] = row[FOLDER].split("/");
  const small = [row[SESSION], name === row[TARGET] ? "" : row[TARGET]].filter(Boolean).join(", ");
  const buttons = RATINGS.map(word => element("button", {"data-rating": word, onclick: () => { choose(k); rate(word); }},
    word[0].toUpperCase() + word.slice(1)));
  const card = element("article", {className: "case", id: "c" + k, onclick: () => choose(k, false)},
    element("header", {}, element("h3", {}, patient + " · " + name + " ", element("small", {}, small)),
      element("span", {className: "place"}, "№ " + ((page - 1) * GALLERY.page + k + 1) +
        (row[SECONDS] ? " · " + Number(row[SECONDS].toPrecision(2)) + " s" : ""))),
    element("div", {className: "flags"}, ...chipsOf(row)), pictureOf(row), ...row[REGIONS].flatMap(barOf),
    element("div", {className: "rate"}, ...buttons));
  return card;
}

function showRating(k) {
  const rating = ratingOf(rows[k]), card = byId("c" + k);
  card.dataset.rating = rating;
  for (const button of card.querySelectorAll(".rate button"))
    button.setAttribute("aria-pressed", String(button.dataset.rating === rating));
  const wanted = byId("show").value;
  card.hidden = wanted && (wanted === "open" ? rating !== "" : rating !== wanted) && k !== here;
}

function showCounts() {
  const count = Object.fromEntries(RATINGS.map(word => [word, 0]));
  for (const row of rows) if (ratingOf(row)) ++count[ratingOf(row)];
  byId("counts").textContent = "this page: " + RATINGS.map(word => count[word] + " " + word).join(", ") + "; in this browser: " +
    Object.values(rated).filter(own => own[0]).length + " rated";
  byId("nothing").hidden = rows.some((_, k) => !byId("c" + k).hidden);
}

function choose(k, scroll = true) {
  if (k < 0 || k >= rows.length) return;
  if (here >= 0) byId("c" + here).classList.remove("here", ...(k === here ? [] : ["large"]));
  const before = here;
  here = k;
  const card = byId("c" + k);
  card.classList.add("here");
  if (before >= 0 && before !== k) showRating(before);
  showRating(k);
  if (scroll) card.scrollIntoView({block: "nearest"});
  history.replaceState(null, "", "#" + ((page - 1) * GALLERY.page + k + 1));
}

function rate(word) {
  if (here < 0) return;
  const row = rows[here];
  rated[row[FOLDER]] = [word, row[KEY]];
  if (word === row[RATING]) delete rated[row[FOLDER]];
  try { localStorage.setItem(memory, JSON.stringify(rated)); } catch { /* the download still has them */ }
  showRating(here);
  showCounts();
}

function step(by) {
  let k = here + by;
  while (k >= 0 && k < rows.length && byId("c" + k).hidden) k += by;
  if (k >= rows.length) return page < pages ? open(page * GALLERY.page + 1) : undefined;
  if (k < 0) return page > 1 ? open((page - 1) * GALLERY.page) : undefined;
  choose(k);
}

async function open(place) {
  place = Math.min(Math.max(1, place || 1), Math.max(1, GALLERY.cases));
  page = Math.ceil(place / GALLERY.page);
  const first = (page - 1) * GALLERY.page, file = Math.floor(first / GALLERY.file);
  byId("page").value = page;
  byId("page").max = pages;
  byId("of").textContent = "of " + pages.toLocaleString("en");
  let list = [];
  try {
    list = await fileOf(file);
  } catch (error) {
    byId("cards").replaceChildren(element("p", {className: "notice bad"}, "There is no file " + error.message +
      "; it lies beside this page, in the folder gallery of the cohort."));
    return;
  }
  rows = list.slice(first - file * GALLERY.file, first - file * GALLERY.file + GALLERY.page);
  here = -1;
  byId("cards").replaceChildren(...rows.map(cardOf));
  rows.forEach((_, k) => showRating(k));
  if (rows.length) choose(place - first - 1);
  if (place === first + 1) scrollTo(0, 0);
  showCounts();
}

// Ratings of all files that were taken along, and those of this browser.
async function download() {
  const lines = new Map();
  for (let k = 0; k * GALLERY.file < GALLERY.cases; ++k)
    for (const row of await fileOf(k)) if (ratingOf(row)) lines.set(row[FOLDER], [ratingOf(row), row[KEY]]);
  const text = ["patient\tcase_id\trating\tkey"];
  for (const [folder, [rating, key]] of lines) text.push([...folder.split("/").slice(1), rating, key].join("\t"));
  const link = element("a", {download: "ratings.tsv", href: URL.createObjectURL(new Blob([text.join("\n") + "\n"]))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const keys = {
  ArrowRight: () => step(1), ArrowLeft: () => step(-1), j: () => step(1), k: () => step(-1), n: () => step(1), p: () => step(-1),
  a: () => { rate("accept"); step(1); }, r: () => { rate("reject"); step(1); }, u: () => { rate("unsure"); step(1); },
  0: () => rate(""), d: download, Enter: () => { byId("c" + here).classList.toggle("large"); choose(here); },
  PageDown: () => open(page * GALLERY.page + 1), PageUp: () => open((page - 2) * GALLERY.page + 1),
};
addEventListener("keydown", event => {
  const typing = ["INPUT", "SELECT"].includes(event.target.tagName);
  const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!action || typing || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Enter" && event.target.tagName === "BUTTON") return;
  event.preventDefault();
  action();
});
addEventListener("hashchange", () => open(Number(location.hash.slice(1))));
byId("back").onclick = keys.PageUp;
byId("on").onclick = keys.PageDown;
byId("page").onchange = event => { event.target.blur(); open((Number(event.target.value) - 1) * GALLERY.page + 1); };
byId("show").onchange = event => { event.target.blur(); rows.forEach((_, k) => showRating(k)); showCounts(); };
byId("download").onclick = download;
open(Number(location.hash.slice(1)));
