// Where no font with measures for mathematics is installed, Chromium leaves subscripts on the line:
// site.css then lowers them.
addEventListener("DOMContentLoaded", () => {
    const sub = document.querySelector("math msub");
    if (!sub) return;
    const [letter, index] = [...sub.children].map((part) => part.getBoundingClientRect().bottom);
    const height = parseFloat(getComputedStyle(sub).fontSize);
    if (index - letter < 0.1 * height) document.documentElement.classList.add("flat-math");
});
