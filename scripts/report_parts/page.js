"use strict";
// Tables sort by a click on a head: numbers as numbers, by all their digits; empty cells last.
function sort(head) {
  const table = head.closest("table"), body = table.tBodies[0];
  const column = head.cellIndex;
  const down = head.getAttribute("aria-sort") === "ascending";
  const key = (row) => {
    const cell = row.cells[column];
    return cell.dataset.v === undefined ? cell.textContent : Number(cell.dataset.v);
  };
  const compare = (a, b) => {
    const x = key(a), y = key(b);
    if (x === "" || y === "") return (x === "") - (y === "");
    const order = typeof x === "number" && typeof y === "number"
      ? x - y : String(x).localeCompare(String(y), undefined, {numeric: true});
    return down ? -order : order;
  };
  body.append(...[...body.rows].sort(compare));
  table.querySelectorAll("th").forEach((other) => other.removeAttribute("aria-sort"));
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
}
document.querySelectorAll(".sortable thead th").forEach((head) =>
  head.querySelector("button").addEventListener("click", () => sort(head)));

// The numbers of a point, at once and on a touch screen: <title> stays for those without a script.
const tip = document.getElementById("tip");
document.querySelectorAll(".point").forEach((point) => {
  const title = point.querySelector("title");
  const words = title.textContent;
  title.remove();
  point.setAttribute("aria-label", words);
  point.addEventListener("pointerenter", (event) => {
    tip.textContent = words;
    tip.hidden = false;
    const space = window.innerWidth - tip.offsetWidth - 8;
    tip.style.left = Math.max(8, Math.min(event.clientX + 12, space)) + "px";
    tip.style.top = Math.max(8, event.clientY - tip.offsetHeight - 12) + "px";
  });
  point.addEventListener("pointerleave", () => { tip.hidden = true; });
});
window.addEventListener("scroll", () => { tip.hidden = true; }, {passive: true});

// Pairs of pictures.
document.querySelectorAll(".pair").forEach((pair) => {
  const frame = pair.querySelector(".frame"), gain = pair.querySelector(".gain");
  const difference = pair.querySelector(".difference"), output = pair.querySelector("output");
  const show = () => {
    output.textContent = 2 ** gain.value;
    frame.classList.toggle("differs", difference.checked);
    frame.style.filter = difference.checked ? `brightness(${2 ** gain.value})` : "";
  };
  pair.querySelector(".slider").addEventListener("input", (event) =>
    frame.style.setProperty("--at", event.target.value + "%"));
  difference.addEventListener("change", show);
  gain.addEventListener("input", show);
});
