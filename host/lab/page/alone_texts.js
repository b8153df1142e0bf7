/** Texts of a page that runs the robot by itself. */

export const aloneTexts = {
    loading: "The robot is being loaded: 14 MB the first time, and then none …",
    failed: (why) => ({
        title: "The robot does not run",
        message: why,
        hint:
            "try again, or in a newer browser: Chrome 115, Edge 115, Firefox 115, Safari 16.4. If" +
            " that does not help, tell your teacher",
    }),
    noSeed: (seed) => ({
        message: `'${seed}' is no seed, so the robot has one by chance`,
        hint: "a seed is a whole number from 0 to 4294967295, as in ?seed=1",
    }),
    note:
        "The robot is simulated in this page: nothing is installed, and nothing leaves it. After" +
        " a reload another robot begins. Logs, basins, predictions, guided exercises and a class" +
        " need the whole lab, ‘kickctl lab’ on a computer.",
};
