"""The explorer in a real browser, from a file: values, bits, controls, pictures, time."""

import math

import pytest

import lutgen
from firmware_export.explore import answers_of_recipe, page_text
from proofs.explorer import STATES, equal

pytestmark = pytest.mark.needs("chromium", "chromedriver", "selenium")
ROBOTS = ("paper_two", "articulated", "absolem")
# States whose tip angle is too small by more than the page prints (docs/measured/explorer.md).
OFF = {"absolem": 1}
# Of the processor's time: milliseconds of script a frame, seconds until the first picture.
MOST_SCRIPT, MOST_FIRST = 8.0, 1.0
COLOURS = """
explorer.shot();
const from = document.querySelector(arguments[0]), to = document.createElement("canvas");
[to.width, to.height] = [from.width, from.height];
const context = to.getContext("2d");
context.drawImage(from, 0, 0);
const pixels = context.getImageData(0, 0, to.width, to.height).data;
return new Set(new Uint32Array(pixels.buffer)).size;
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("pages")
    found = {}
    for name in ROBOTS:
        recipe = lutgen.load_recipe(f"recipe:{name}")
        held = answers_of_recipe(recipe)
        path = folder / f"{name}.html"
        path.write_text(page_text(recipe, held), encoding="utf-8")
        found[name] = recipe, held, path
    return found


@pytest.fixture(scope="module")
def browser():
    from proofs.browser import Browser

    one = Browser()
    yield one
    one.close()


def colours(browser, canvas: str) -> int:
    """Return how many colours a canvas shows; the 3-D one can be read where it was just drawn."""
    return browser.driver.execute_script(COLOURS, canvas)


@pytest.mark.parametrize("name", ROBOTS)
def test_200_states_are_those_of_lutgen_eval_and_bits_are_the_hosts(
    name: str, pages, browser
) -> None:
    recipe, held, path = pages[name]
    browser.open(path)
    found = equal(browser, recipe, held, path.stat().st_size)
    assert (found.verdicts, found.lengths, found.bits) == (STATES, STATES, STATES)
    assert found.tips >= STATES - OFF.get(name, 0)
    assert found.over == 0
    assert browser.complaints() == []


def test_every_control_moves_what_it_says(pages, browser) -> None:
    browser.open(pages["absolem"][2])
    move = (
        "((selector, value) => { const one = document.querySelector(selector); one.value = value;"
        "one.dispatchEvent(new Event('input', {bubbles: true}));"
        "one.dispatchEvent(new Event('change', {bubbles: true})); return true; })"
    )

    def moved(selector: str, value: str, what: str, expected: object) -> None:
        assert browser.ask(f"{move}({selector!r}, {value!r})")
        assert browser.ask(what) == pytest.approx(expected, abs=1e-6), selector

    radians = math.radians
    moved("#range-joint-0", "36", "explorer.state.now.q[0]", radians(36))
    moved("#range-joint-1", "-72", "explorer.state.now.q[1]", radians(-72))
    moved("#number-joint-1", "10.5", "explorer.state.now.q[1]", radians(10.5))
    moved("#range-tilt", "12", "explorer.state.now.tilt", radians(12))
    moved("#range-heading", "-40", "explorer.state.now.heading", radians(-40))
    moved("#range-mu", "0.1", "explorer.state.now.mu", 0.1)
    moved("#axis-x", "1", "explorer.state.now.axes[0]", 1)
    moved("#axis-y", "0", "explorer.state.now.axes[1]", 0)
    assert browser.ask(f"{move}('#what', 'sdg')")
    assert browser.ask("explorer.state.now.what") == "sdg"
    browser.until("document.querySelector('[data-is=slope]').textContent.endsWith('slides')")
    browser.driver.find_element("css selector", "[name=mode][value=body]").click()
    assert browser.ask("explorer.state.now.mode") == "body"
    # In the body's frame gravity is what the sliders say; on the ground the robot is seated.
    down = [math.sin(radians(12)) * math.cos(radians(-40))]
    browser.until(f"Math.abs(explorer.last().g[0] - {down[0]}) < 1e-9")
    theme = "document.documentElement.dataset.theme"
    before = browser.ask(theme)
    browser.driver.find_element("css selector", "[data-key=d]").click()
    assert browser.ask(theme) != before
    browser.driver.find_element("css selector", "[data-key=l]").click()
    assert browser.ask("explorer.state.now.tilt") == 0
    browser.driver.find_element("css selector", "[data-key=r]").click()
    assert browser.ask("explorer.state.now.q") == [0, 0]
    assert browser.complaints() == []


def test_keys_and_drags_move_gravity(pages, browser) -> None:
    from selenium.webdriver import ActionChains, Keys

    browser.open(pages["absolem"][2])
    ActionChains(browser.driver).send_keys(Keys.ARROW_UP, Keys.ARROW_UP, Keys.ARROW_LEFT).perform()
    assert browser.ask("explorer.state.now.tilt") == pytest.approx(
        math.radians(math.hypot(2, 1)), 1e-2
    )
    ActionChains(browser.driver).send_keys("l").perform()
    view = browser.driver.find_element("id", "view")
    across = view.size["width"] // 2
    for place, mode in (((-across + 60, 60), "ground"), ((0, 20), "body")):
        drag = ActionChains(browser.driver).move_to_element_with_offset(view, *place)
        drag.click_and_hold().move_by_offset(40, 20).release().perform()
        assert browser.ask("[explorer.state.now.mode, explorer.state.now.tilt > 0.02]") == [
            mode,
            True,
        ]
    disc = browser.driver.find_element("id", "disc")
    ActionChains(browser.driver).move_to_element_with_offset(disc, 30, 0).click().perform()
    browser.until("explorer.last().g[1] < -0.1")
    plane = browser.driver.find_element("id", "map")
    ActionChains(browser.driver).move_to_element_with_offset(plane, 40, -30).click().perform()
    assert all(browser.ask("explorer.state.now.q.map((x) => x > 0.1)"))
    assert browser.complaints() == []


def test_pictures_are_not_blank_and_the_address_holds_the_state(pages, browser) -> None:
    state = "#p.alpha=40&p.gamma=20&mode=body&tilt=15&heading=30&mu=0.5&map=1.0&what=sdg&theme=dark"
    browser.open(pages["paper_two"][2], state)
    browser.until("explorer.disc()?.size === 180 && explorer.map()?.size === 61")
    browser.until("document.querySelector('[data-is=spoken]').textContent.includes('tipping')")
    for canvas, least in (("#view", 40), ("#disc", 12), ("#map", 12), ("#trace", 2)):
        assert colours(browser, canvas) >= least, canvas
    now = browser.ask("explorer.state.now")
    assert now["q"] == pytest.approx([math.radians(40), math.radians(20)])
    assert (now["mode"], now["axes"], now["what"], now["theme"]) == ("body", [1, 0], "sdg", "dark")
    assert browser.ask("explorer.state.text().includes('p.alpha=40&')")
    head, row = browser.ask("explorer.csv()").splitlines()[:2]
    assert len(head.split(",")) == len(row.split(",")) == 15
    assert browser.ask("explorer.shot().toDataURL('image/png').length") > 20_000
    assert browser.complaints() == []


def test_frames_are_cheap_and_the_first_picture_is_there_soon(pages, browser) -> None:
    # The processor's own time, since other programs may run beside the test.
    browser.driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    browser.open(pages["absolem"][2])
    assert browser.seconds("TaskDuration") <= MOST_FIRST
    walk = (
        "const done = arguments[0]; explorer.timing.script.length = 0; let n = 0;"
        "const step = () => { n++; explorer.state.set({ q: [Math.sin(n / 20), Math.cos(n / 15)],"
        "tilt: 0.2 + 0.1 * Math.sin(n / 9), heading: n / 30 });"
        "n < 25 ? requestAnimationFrame(step) : done(explorer.timing.script); }; step();"
    )
    before = browser.seconds("ScriptDuration")
    spent = browser.driver.execute_async_script(walk)
    assert len(spent) >= 15
    assert 1000.0 * (browser.seconds("ScriptDuration") - before) / len(spent) <= MOST_SCRIPT
    assert browser.complaints() == []
