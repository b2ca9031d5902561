// SPDX-License-Identifier: BSD-3-Clause
// Moving by keyboard: arrows between the cells of a table, and a focus that stays where it is when what has it is drawn anew.

/** Moves the focus between the buttons in the cells of a table by the arrow keys, Home and End. */
export function moveByArrows(table: HTMLTableElement) {
  const steps: Record<string, [number, number]> = {
    ArrowLeft: [0, -1],
    ArrowRight: [0, 1],
    ArrowUp: [-1, 0],
    ArrowDown: [1, 0],
    Home: [0, -Infinity],
    End: [0, Infinity],
  };
  table.addEventListener("keydown", (event) => {
    const step = steps[event.key];
    const from = (event.target as Element).closest("td");
    if (!step || !from || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const buttons = [...table.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.querySelector("button")));
    const row = (from.parentElement as HTMLTableRowElement).sectionRowIndex;
    const last = buttons[row].length - 1;
    const at = (i: number, k: number) => buttons[i]?.[k];
    if (Number.isFinite(step[1])) {
      let [i, k] = [row + step[0], from.cellIndex + step[1]];
      while (buttons[i] && k >= 0 && k <= last && !at(i, k)) [i, k] = [i + step[0], k + step[1]]; // over what was not tried
      at(i, k)?.focus();
    } else {
      const known = buttons[row].filter((button) => button);
      known[step[1] < 0 ? 0 : known.length - 1]!.focus();
    }
  });
}

/** Says again which element has the focus: by its id or name, or by its title within the part of the page that has an id. */
function selectorOf(focused: Element | null): string | null {
  if (!focused || focused === document.body) return null;
  const part = focused.closest("[id]");
  const inPart = part && part !== focused ? `#${CSS.escape(part.id)} ` : "";
  const quoted = (name: string) => `[${name}="${CSS.escape(focused.getAttribute(name)!)}"]`;
  if (focused.id) return `#${CSS.escape(focused.id)}`;
  if (focused.hasAttribute("name")) return `${focused.localName}${quoted("name")}`;
  if (focused.hasAttribute("title")) return `${inPart}${focused.localName}${quoted("title")}`;
  return null;
}

/** Draws something anew; what had the focus before has it afterwards, too. */
export function keepFocus(draw: () => void) {
  const selector = selectorOf(document.activeElement);
  draw();
  const active = document.activeElement;
  if (selector && (!active || active === document.body)) document.querySelector<HTMLElement>(selector)?.focus({ preventScroll: true });
}
