/** Small helpers for elements. */

/** @param {string} id @returns {HTMLElement} */
export const byId = (id) => document.getElementById(id);

/**
 * A new element.
 * @param {string} tag
 * @param {object} properties Properties of the element, such as className.
 * @param {...(Node | string)} children
 * @returns {HTMLElement}
 */
export function element(tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
}

/** Set a text only if it is another one: an equal one would be laid out and read out again. */
export function setText(target, text) {
    if (target.textContent !== text) target.textContent = text;
}

/** Show or hide an element. */
export function show(target, visible) {
    if (target.hidden === visible) target.hidden = !visible;
}

/** Fill in the words of all elements that name theirs by data-text or data-label. */
export function fillTexts(texts) {
    for (const target of document.querySelectorAll("[data-text]")) {
        target.textContent = texts[target.dataset.text];
    }
    for (const target of document.querySelectorAll("[data-label]")) {
        target.setAttribute("aria-label", texts[target.dataset.label]);
    }
}

/**
 * A button with a text.
 * @param {string} text
 * @param {() => void} act What a click does.
 * @param {string} className
 */
export function button(text, act, className = "") {
    return element("button", { type: "button", textContent: text, onclick: act, className });
}

/** The options of a choice, from names to labels. */
export function options(labels) {
    return Object.entries(labels).map(([value, label]) => ({ value, label }));
}

/**
 * A group of choices of which one holds. Not a select: its open list would keep Esc from stopping
 * the robot.
 * @param {string} name Unique in the page.
 * @param {string} legend
 * @param {{value: *, label: string}[]} options
 * @param {*} chosen The value at first.
 * @param {(value: *) => void} onchoice
 * @returns {HTMLFieldSetElement & {choose: (value: *) => void, value: *,
 *     allow: (can: (value: *) => boolean) => void}}
 */
export function choices(name, legend, options, chosen, onchoice = () => {}) {
    const group = element("fieldset", { className: "choices" }, element("legend", {}, legend));
    const inputs = options.map(({ value, label }, index) => {
        const id = `${name}-${index}`;
        const input = element("input", { type: "radio", name, id });
        input.onchange = () => {
            group.value = value;
            onchoice(value);
        };
        group.append(element("span", {}, input, element("label", { htmlFor: id }, label)));
        return input;
    });
    group.choose = (value) => {
        group.value = value;
        inputs.forEach((input, index) => {
            input.checked = options[index].value === value;
        });
    };
    group.allow = (can) =>
        inputs.forEach((input, index) => {
            input.disabled = !can(options[index].value);
        });
    group.choose(chosen);
    return group;
}

/**
 * A field for a number. It takes a decimal comma, too, which browsers in English leave out: 2,5
 * would become 25.
 * @param {object} properties
 * @returns {HTMLInputElement}
 */
export function numberInput(properties) {
    const input = element("input", { type: "number", ...properties });
    input.addEventListener("beforeinput", (event) => {
        const given = event.data ?? event.dataTransfer?.getData("text/plain") ?? "";
        if (!/^[^.,]*,[^.,]*$/.test(given)) return;
        event.preventDefault();
        // The only way into a number field at the cursor.
        document.execCommand("insertText", false, given.replace(",", "."));
    });
    return input;
}

/**
 * A labelled number with a place for what it means.
 * @param {string} id
 * @param {string} text The label.
 * @param {object} properties Of the input.
 * @returns {{root: HTMLElement, input: HTMLInputElement, label: HTMLElement, output: HTMLElement}}
 */
export function numberField(id, text, properties) {
    const input = numberInput({ id, ...properties });
    const label = element("label", { htmlFor: id }, text);
    const output = element("output", { className: "meaning" });
    output.htmlFor.add(id);
    return {
        input,
        label,
        output,
        root: element("div", { className: "field" }, label, input, output),
    };
}
