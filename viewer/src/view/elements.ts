// SPDX-License-Identifier: BSD-3-Clause
// The few HTML controls that the panel is made of.

type Child = Node | string;

/** The JSON in the element with this id. */
export const jsonOf = <T>(id: string) => JSON.parse(document.getElementById(id)!.textContent!) as T;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Record<string, unknown> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) (made as unknown as Record<string, unknown>)[name] = value;
    else made.setAttribute(name, String(value));
  }
  made.append(...children);
  return made;
}

export function section(title: string, ...children: Child[]): HTMLElement {
  return element("section", {}, element("h2", {}, title), ...children);
}

export function button(label: string, title: string, action: () => void): HTMLButtonElement {
  return element("button", { type: "button", title, onclick: action }, label);
}

export function checkbox(label: string, checked: boolean, onChange: (checked: boolean) => void): HTMLLabelElement {
  const input = element("input", { type: "checkbox", checked });
  input.onchange = () => onChange(input.checked);
  return element("label", { className: "check" }, input, label);
}

export function choice<T extends string>(label: string, options: readonly T[], value: T, onChange: (value: T) => void): HTMLLabelElement {
  const select = element("select", {}, ...options.map((o) => element("option", { value: o, selected: o === value }, o)));
  select.onchange = () => onChange(select.value as T);
  return element("label", { className: "field" }, label, select);
}

export interface SliderOptions {
  min: number;
  max: number;
  step: number;
  value: number;
  shown: (value: number) => string;
}

export interface Slider {
  element: HTMLLabelElement;
  set(value: number): void;
}

export function slider(label: string, options: SliderOptions, onInput: (value: number) => void): Slider {
  const { min, max, step, value, shown } = options;
  const input = element("input", { type: "range", min, max, step, "aria-label": label });
  const output = element("output", {}, shown(value));
  input.value = String(value);
  input.oninput = () => {
    output.textContent = shown(Number(input.value));
    onInput(Number(input.value));
  };
  return {
    element: element("label", { className: "field slider" }, label, input, output),
    set(next) {
      input.value = String(next);
      output.textContent = shown(next);
    },
  };
}

/** Calls `action` once, when the element is in sight or nearly so. */
export function whenInSight(target: Element, action: () => void): IntersectionObserver {
  const watch = new IntersectionObserver(
    (entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      watch.disconnect();
      action();
    },
    { rootMargin: "600px" },
  );
  watch.observe(target);
  return watch;
}
