"""When the lab's page asks what the simulation expects of the usual kicks."""

from tests.web.drawings import open_page

# Asks at some times, ms, with the wheels that would be kicked; tells after each what that asked,
# and what is known of the first kick.
SCRIPT = """
    async (calls) => {
        const { createExpectation } = await import("/expectation.js");
        let now = 0;
        performance.now = () => now;
        const asked = [], told = [];
        const robot = { name: "anna", kicks: [], status: { params: { k: 4 } } };
        const request = async ({ kick }) => {
            asked.push(`${kick.mode} ${kick.wheel}`);
            return { shares: {}, of: 96 };
        };
        const kicks = [{ mode: "membrane" }, { mode: "phase" }];
        const expectation = createExpectation({ store: { robot }, request }, kicks);
        for (const [at, wheel] of calls) {
            now = at;
            expectation.renew(wheel);
            await new Promise((done) => setTimeout(done));
            told.push([asked.splice(0), Boolean(expectation.of(0))]);
        }
        return told;
    }
"""


def test_it_asks_again_when_something_changes_or_time_has_passed(browser):
    page = open_page(browser)
    both, left = (["membrane both", "phase both"], ["membrane left", "phase left"])
    calls = [(0, "both"), (9e3, "both"), (11e3, "both"), (12e3, "left"), (13e3, None), (30e3, None)]
    asked, known = zip(*page.evaluate(SCRIPT, calls), strict=True)
    assert asked == (both, [], both, left, [], [])
    assert known == (True, True, True, True, False, False)
    page.close()
