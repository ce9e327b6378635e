// The page's own elements.

export function element<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}

/** Of a number that may be missing. */
export const fixed = (x: number | null | undefined, digits: number): string =>
  x === null || x === undefined || !Number.isFinite(x) ? "–" : x.toFixed(digits);

let hide = 0;

/** A line for whoever asked for something. */
export function note(text: string): void {
  const place = element("note");
  place.textContent = text;
  place.classList.add("shown");
  window.clearTimeout(hide);
  hide = window.setTimeout(() => place.classList.remove("shown"), 4000);
}
