const number = text => { const n = text.replace(/^[<>±~≈\s]+/, "").match(/^[-−+]?\d[\d \u00a0]*\.?\d*(e[+-]?\d+)?/i); return n ? parseFloat(n[0].replace(/[ \u00a0]/g, "").replace("−", "-")) : NaN; };
const unit = text => text.replace(/^.*[\d\])]/, "").trim();
const compare = (a, b) => {
  const x = number(a), y = number(b);
  if (isNaN(x) || isNaN(y)) return isNaN(x) && isNaN(y) ? a.localeCompare(b) : isNaN(x) ? 1 : -1;
  return unit(a).localeCompare(unit(b)) || x - y;
};
const say = text => { document.getElementById("said").textContent = text; };
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], given = [...body.rows];
  for (const button of table.querySelectorAll("th button")) button.addEventListener("click", () => {
    const th = button.parentElement, at = th.cellIndex, before = th.getAttribute("aria-sort");
    for (const other of th.parentElement.cells) other.removeAttribute("aria-sort");
    const now = { null: "ascending", ascending: "descending" }[before];
    if (now) th.setAttribute("aria-sort", now);
    const text = row => row.cells[at] ? row.cells[at].textContent.trim() : "";
    const sign = now === "descending" ? -1 : 1;
    body.append(...(now ? [...given].sort((a, b) => sign * compare(text(a), text(b))) : given));
    say(now ? `sorted by ${button.textContent}, ${now}` : "in the order as it was");
  });
}
for (const button of document.querySelectorAll("button.copy")) button.addEventListener("click", () => {
  const table = button.parentElement.querySelector("table"), selection = getSelection();
  selection.selectAllChildren(table);
  const done = document.execCommand("copy");
  selection.removeAllRanges();
  say(done ? "copied" : "not copied");
  button.firstChild.textContent = done ? "Copied" : "Select and copy by hand";
  setTimeout(() => { button.firstChild.textContent = "Copy"; }, 2000);
});
const folds = [...document.querySelectorAll("details")];
for (const button of document.querySelectorAll("button.all")) button.addEventListener("click", () => {
  const own = [...(button.closest("section") || document).querySelectorAll("details")], open = !own.every(one => one.open);
  for (const one of own) one.open = open;
  button.textContent = open ? "Close all" : "Open all";
});
const opened = () => { const part = document.getElementById(location.hash.slice(1)); if (part instanceof HTMLDetailsElement) { part.open = true; part.scrollIntoView(); } };
addEventListener("hashchange", opened);
opened();
const reach = () => { for (const box of document.querySelectorAll(".scroll")) if (box.scrollWidth > box.clientWidth + 1) { box.tabIndex = 0; box.setAttribute("role", "group"); box.setAttribute("aria-label", "wide: scroll sideways"); } else { box.removeAttribute("tabindex"); box.removeAttribute("role"); box.removeAttribute("aria-label"); } };
addEventListener("resize", reach);
for (const one of folds) one.addEventListener("toggle", reach);
reach();
let closed = [];
addEventListener("beforeprint", () => { closed = folds.filter(one => !one.open); for (const one of closed) one.open = true; });
addEventListener("afterprint", () => { for (const one of closed) one.open = false; });
