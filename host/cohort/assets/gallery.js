// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Needs GALLERY: cases, page, file, flags, counts, low, high. Rows come from gallery/rows-NNNN.js, each
// [folder, target, session, key, rating, [[region, verdict, E, low, high]], seconds, sentence, flags].
const [FOLDER, TARGET, SESSION, KEY, RATING, REGIONS, SECONDS, SENTENCE, FLAGS] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
const RATINGS = ["accept", "reject", "unsure"];
const byId = id => document.getElementById(id);
const files = new Map();
const memory = "palpate ratings " + location.pathname;
// matches: places of the cases that are asked for, in order; null: all. rows: [place, row] of the page.
let rated = {}, page = 1, rows = [], here = -1, matches = null, filtering = 0, opening = 0;

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
  const label = known ? name + ": " + text.lastChild.textContent : name + ": " + verdict + ", " + number(low) + " to " + number(high) + " kPa";
  const colour = !known ? "var(--line)" : verdict === "weak" ? "var(--weak)" : "var(--accent)";
  const holder = element("div");
  holder.innerHTML = "<svg class='bar-of-e' viewBox='0 0 400 30' preserveAspectRatio='none' role='img'>" +
    "<path d='M0 8H400' stroke='var(--line)'/>" +
    "<path d='M" + xOf(low) + " 8H" + xOf(high) + "' stroke='" + colour + "' stroke-width='5'/>" +
    (known ? "<circle cx='" + xOf(e) + "' cy='8' r='5' fill='" + colour + "'/>" : "") +
    "<text x='0' y='27'>" + number(GALLERY.low) + "</text><text x='400' y='27' text-anchor='end'>" +
    number(GALLERY.high) + " kPa</text></svg>";
  holder.firstChild.setAttribute("aria-label", label);
  return [text, holder.firstChild];
}

function chipsOf(row) {
  const grave = 7;  // flags before that are red
  return GALLERY.flags.filter((_, k) => row[FLAGS] >> k & 1).map(name => element("span",
    {className: "chip " + (GALLERY.flags.indexOf(name) < grave ? "bad" : "weak")}, name));
}

const nameOf = row => row[FOLDER].split("/").slice(1).join(" · ");

function pictureOf(row) {
  const without = text => element("div", {className: "none"}, text);
  if (row[FLAGS] & 1) return without("Failed: " + row[SENTENCE]);
  const picture = element("img", {loading: "lazy", alt: "three slices of " + nameOf(row) + " with contours", src: "cases/" + row[FOLDER] + "/card.svg"});
  picture.onerror = () => picture.replaceWith(without("There is no picture of this case."));
  return picture;
}

function cardOf([place, row], k) {
  const name = row[FOLDER].split("/")[2];
  const small = [row[SESSION], name === row[TARGET] ? "" : row[TARGET]].filter(Boolean).join(", ");
  const buttons = RATINGS.map(word => element("button", {"data-rating": word, tabIndex: -1, onclick: () => { choose(k); rate(word); }},
    word[0].toUpperCase() + word.slice(1)));
  return element("article", {className: "case", id: "c" + k, tabIndex: -1, "aria-labelledby": "h" + k, onclick: () => choose(k, false)},
    element("header", {}, element("h3", {id: "h" + k}, nameOf(row) + " ", element("small", {}, small)),
      element("span", {className: "place"}, "№ " + place + (row[SECONDS] ? " · " + Number(row[SECONDS].toPrecision(2)) + " s" : ""))),
    element("div", {className: "flags"}, ...chipsOf(row)), pictureOf(row), ...row[REGIONS].flatMap(barOf),
    element("div", {className: "rate", role: "group", "aria-label": "Rating"}, ...buttons));
}

function showRating(k) {
  const rating = ratingOf(rows[k][1]), card = byId("c" + k);
  card.dataset.rating = rating;
  for (const button of card.querySelectorAll(".rate button"))
    button.setAttribute("aria-pressed", String(button.dataset.rating === rating));
}

function showCounts() {
  const count = Object.fromEntries(RATINGS.map(word => [word, 0]));
  for (const [, row] of rows) if (ratingOf(row)) ++count[ratingOf(row)];
  const words = RATINGS.filter(word => count[word]).map(word => count[word] + " " + word).join(", ") || "none rated";
  const own = Object.values(rated).filter(([word]) => word).length;
  byId("counts").textContent = (matches ? matches.length.toLocaleString("en") + " shown; " : "") + "this page: " + words +
    (own ? "; in this browser: " + own + " rated" : "");
  byId("nothing").hidden = rows.length > 0;
}

const numShown = () => matches ? matches.length : GALLERY.cases;
const numPages = () => Math.max(1, Math.ceil(numShown() / GALLERY.page));
const isTyping = () => ["INPUT", "SELECT"].includes((document.activeElement || {}).tagName);

function choose(k, scroll = true) {
  if (k < 0 || k >= rows.length) return;
  const mark = (card, on) => {
    card.classList.toggle("here", on);
    card.tabIndex = on ? 0 : -1;
    for (const button of card.querySelectorAll("button")) button.tabIndex = on ? 0 : -1;
    if (on) card.setAttribute("aria-current", "true");
    else card.removeAttribute("aria-current");
  };
  if (here >= 0) {
    mark(byId("c" + here), false);
    if (k !== here) byId("c" + here).classList.remove("large");
  }
  here = k;
  const card = byId("c" + k);
  mark(card, true);
  if (!isTyping() && !card.contains(document.activeElement)) card.focus({preventScroll: true});
  if (scroll) card.scrollIntoView({block: "nearest"});
  if (!matches) history.replaceState(null, "", "#" + rows[k][0]);
}

function rate(word) {
  if (here < 0) return;
  const row = rows[here][1];
  rated[row[FOLDER]] = [word, row[KEY]];
  if (word === row[RATING]) delete rated[row[FOLDER]];
  try { localStorage.setItem(memory, JSON.stringify(rated)); } catch { /* the download still has them */ }
  showRating(here);
  showCounts();
}

function step(by) {
  const k = here + by;
  if (k >= rows.length) return page < numPages() ? open(page * GALLERY.page + 1) : choose(rows.length - 1);
  if (k < 0) return page > 1 ? open((page - 1) * GALLERY.page) : choose(0);
  choose(k);
}

const columns = () => getComputedStyle(byId("cards")).gridTemplateColumns.split(" ").length;

// [place, row] of the cases from one place on.
async function rowsFrom(first, count) {
  const found = [];
  const placesOf = matches ? matches.slice(first, first + count) :
    Array.from({length: Math.min(count, GALLERY.cases - first)}, (_, k) => first + k + 1);
  for (const place of placesOf)
    found.push([place, (await fileOf(Math.floor((place - 1) / GALLERY.file)))[(place - 1) % GALLERY.file]]);
  return found;
}

function tellMissing(error) {
  byId("cards").replaceChildren(element("p", {className: "notice bad"}, "There is no file " + error.message +
    "; it lies beside this page, in the folder gallery of the cohort."));
}

// The page with the n-th of the cases that are shown.
async function open(n) {
  n = Math.min(Math.max(1, n || 1), Math.max(1, numShown()));
  page = Math.ceil(n / GALLERY.page);
  const first = (page - 1) * GALLERY.page;
  byId("page").value = page;
  byId("page").max = numPages();
  byId("of").textContent = "of " + numPages().toLocaleString("en");
  const own = ++opening;
  let found;
  try {
    found = await rowsFrom(first, GALLERY.page);
  } catch (error) {
    opening = 0;
    return tellMissing(error);
  }
  if (own !== opening) return;  // another page was asked for meanwhile
  opening = 0;
  rows = found;
  here = -1;
  byId("cards").replaceChildren(...rows.map(cardOf));
  rows.forEach((_, k) => showRating(k));
  if (rows.length) choose(n - first - 1);
  if (n === first + 1) scrollTo(0, 0);
  showCounts();
}

// Calls visit(place, row) for every case; false once a later filter than `own` was set.
async function visitAll(visit, own = filtering) {
  const files = Math.ceil(GALLERY.cases / GALLERY.file);
  for (let k = 0; k < files; ++k) {
    if (files > 1) byId("counts").textContent = "reading " + (k + 1) + " of " + files;
    const list = await fileOf(k);
    if (own !== null && own !== filtering) return false;
    list.forEach((row, i) => visit(k * GALLERY.file + i + 1, row));
  }
  return true;
}

// The same whatever is filtered meanwhile; false if a file is missing, which it says.
async function visitWhole(visit) {
  try {
    await visitAll(visit, null);
  } catch (error) {
    tellMissing(error);
    return false;
  }
  showCounts();
  return true;
}

async function filter() {
  const rating = byId("show").value, flag = byId("flag").value, text = byId("find").value.trim().toLowerCase();
  ++filtering;
  let found = null;
  if (rating || flag || text) {
    found = [];
    const isAsked = row => (!rating || (ratingOf(row) || "open") === rating) && (!flag || row[FLAGS] >> Number(flag) & 1) &&
      (!text || (row[FOLDER].slice(3) + " " + row[SESSION] + " " + row[TARGET]).toLowerCase().includes(text));
    try {
      if (!await visitAll((place, row) => { if (isAsked(row)) found.push(place); })) return;
    } catch (error) {
      return tellMissing(error);
    }
  }
  matches = found;
  await open(1);
}

function save(name, lines) {
  const link = element("a", {download: name, href: URL.createObjectURL(new Blob([lines.join("\n") + "\n"]))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Of all that are shown, in their order, with the ratings of this browser; a row for each region.
async function table() {
  const lines = ["patient\tcase_id\ttarget\tsession_id\trating\tflags\tregion\tverdict\te_kpa\te_low_kpa\te_high_kpa\tseconds\tfailure"];
  // One line, and nothing that a spreadsheet takes for a formula or an open quote.
  const cell = value => {
    if (typeof value === "number") return String(value);
    const text = String(value ?? "").replace(/[\t\r\n]+/g, " ").replace(/^[=+@-]/, "'$&");
    return text.includes('"') ? '"' + text.replaceAll('"', '""') + '"' : text;
  };
  const wanted = matches && new Set(matches);
  const all = await visitWhole((place, row) => {
    if (wanted && !wanted.has(place)) return;
    const flags = GALLERY.flags.filter((_, k) => row[FLAGS] >> k & 1).join("; ");
    for (const region of row[REGIONS].length ? row[REGIONS] : [["", "", null, null, null]])
      lines.push([...row[FOLDER].split("/").slice(1), row[TARGET], row[SESSION], ratingOf(row), flags, ...region, row[SECONDS] || "",
        row[SENTENCE]].map(cell).join("\t"));
  });
  if (all) save("gallery.tsv", lines);
}

// Ratings of all files that were taken along, and those of this browser.
async function download() {
  const lines = ["patient\tcase_id\trating\tkey"];
  const all = await visitWhole((_, row) => {
    if (ratingOf(row)) lines.push([...row[FOLDER].split("/").slice(1), ratingOf(row), row[KEY]].join("\t"));
  });
  if (all) save("ratings.tsv", lines);
}

const toggleLarge = () => { if (here >= 0) byId("c" + here).classList.toggle("large"), choose(here); };
const keys = {
  ArrowRight: () => step(1), ArrowLeft: () => step(-1), j: () => step(1), k: () => step(-1), n: () => step(1), p: () => step(-1),
  ArrowDown: () => step(columns()), ArrowUp: () => step(-columns()),
  a: () => { rate("accept"); step(1); }, r: () => { rate("reject"); step(1); }, u: () => { rate("unsure"); step(1); },
  0: () => rate(""), d: download, t: table, Enter: toggleLarge, "/": () => byId("find").select(), f: () => byId("flag").focus(),
  PageDown: () => page < numPages() && open(page * GALLERY.page + 1), PageUp: () => open((page - 2) * GALLERY.page + 1),
};
addEventListener("keydown", event => {
  if (isTyping()) {
    if (event.key !== "Escape" && (event.key !== "Enter" || event.target.id !== "find")) return;
    event.preventDefault();
    event.target.blur();  // what was typed is searched
    if (here >= 0) choose(here);
    return;
  }
  const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Enter" && ["BUTTON", "A"].includes(event.target.tagName)) return;
  event.preventDefault();
  // Nobody has looked at what comes while a key is held down or a page is on its way.
  if (opening || event.repeat && !event.key.startsWith("Arrow")) return;
  action();
});

GALLERY.flags.forEach((name, k) => {
  if (GALLERY.counts[k]) byId("flag").append(element("option", {value: String(k)}, name + " (" + GALLERY.counts[k].toLocaleString("en") + ")"));
});
byId("back").onclick = keys.PageUp;
byId("on").onclick = keys.PageDown;
byId("page").onchange = event => { event.target.blur(); open((Number(event.target.value) - 1) * GALLERY.page + 1); };
for (const id of ["show", "flag", "find"]) byId(id).onchange = filter;
byId("download").onclick = download;
byId("table").onclick = table;

// "#17": the case at that place; "#flag-3": those with that flag.
function openHash() {
  const [, flag] = /^#flag-(\d+)$/.exec(location.hash) || [];
  for (const id of ["show", "find"]) byId(id).value = "";
  byId("flag").value = flag || "";
  if (flag) return filter();
  ++filtering;
  matches = null;
  return open(Number(location.hash.slice(1)));
}
addEventListener("hashchange", openHash);
openHash();
