"""The explorer in a real browser, from a file: answers, controls, pictures, and what it refuses."""

import json
import math

import numpy as np
import pytest

import lutgen
from firmware_export.explore import answers_of_recipe, page_text
from firmware_export.host import Host
from lutgen.channels import body_gravity

pytestmark = pytest.mark.needs("chromium", "chromedriver", "selenium")
# Software rendering, which is what machines without a screen have.
FLAGS = (
    *("--headless=new", "--no-sandbox", "--window-size=1280,860", "--disable-dev-shm-usage"),
    *("--enable-unsafe-swiftshader", "--use-angle=swiftshader"),
)
PATIENCE = 60.0


class Browser:
    def __init__(self):
        from selenium import webdriver

        options = webdriver.ChromeOptions()
        for flag in FLAGS:
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options, webdriver.ChromeService("/usr/bin/chromedriver"))

    def open(self, page, state=""):
        self.driver.get("about:blank")  # another fragment alone would not load it again
        self.driver.get(page.as_uri() + state)
        self.until("globalThis.explorer?.disc.data")

    def until(self, expression):
        from selenium.webdriver.support.ui import WebDriverWait

        WebDriverWait(self.driver, PATIENCE, 0.05).until(lambda _: self.ask(expression))

    def ask(self, expression):
        return self.driver.execute_script(f"return {expression}")

    def press(self, key):
        self.driver.find_element("css selector", f"[data-key={key}]").click()

    def complaints(self):
        return [entry["message"] for entry in self.driver.get_log("browser")]


ROBOTS = ("paper_two", "three_leg_sphere", "absolem")
STATES = 200
ASK = """
return JSON.parse(arguments[0]).map((state) => {
  const { status, sdg, tip, height, g, here } = explorer.answer(state);
  return [status, ...[sdg, tip, height, ...g, here?.height].map((x) => x ?? null)];
});
"""
COLOURS = """
const from = document.querySelector(arguments[0]), to = document.createElement("canvas");
if (from.id === "view") explorer.stage.render();
[to.width, to.height] = [from.width, from.height];
const context = to.getContext("2d");
context.drawImage(from, 0, 0);
const pixels = context.getImageData(0, 0, to.width, to.height).data;
return new Set(new Uint32Array(pixels.buffer)).size;
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
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
    one = Browser()
    yield one
    one.driver.quit()


def asked(browser, mode, params, down):
    """Return status, sdg, tip, height, gravity, and how high the com is over the plane (m, 8)."""
    both = zip(params.tolist(), down.tolist(), strict=True)
    rows = [{"q": q, "mode": mode, "down": g} for q, g in both]
    return np.array(browser.driver.execute_script(ASK, json.dumps(rows)), dtype=np.float64)


def states(recipe, count):
    """Return random params (m, k) and directions (m, 3) up to 45 deg of tilt."""
    rng = np.random.default_rng(1)
    low = [p.minimum for p in recipe.parameters]
    high = [p.maximum for p in recipe.parameters]
    params = rng.uniform(low, high, (count, len(low)))
    away, heading = rng.uniform(0.0, math.pi / 4, count), rng.uniform(0.0, 2.0 * math.pi, count)
    flat = np.sin(away)
    return params, np.stack([flat * np.cos(heading), flat * np.sin(heading), -np.cos(away)], axis=1)


@pytest.mark.parametrize("name", ROBOTS)
def test_answers_have_the_bits_of_the_c_and_a_robot_is_seated_as_lutgen_seats_it(
    name, pages, browser
):
    recipe, held, path = pages[name]
    params, down = states(recipe, STATES)
    browser.open(path)
    assert browser.ask("explorer.runtime.map('check')") == 0
    found = asked(browser, "body", params, down)
    status, reading = Host(held.blob).read(params, down)
    assert set(status) >= {0, 2}
    np.testing.assert_array_equal(found[:, 0], status)
    np.testing.assert_array_equal(found[:, 1:4].astype(np.float32), reading)
    # The plane that is drawn is the one that was read.
    stands = status != 2
    np.testing.assert_allclose(found[stands, 7], reading[stands, 2], rtol=1e-5)
    truth = body_gravity(recipe, params, down, "plane")
    apart = np.abs(asked(browser, "ground", params, down)[:, 4:7] - truth).max(axis=1)
    assert (apart < 1e-4).sum() >= STATES - 2  # of two rests that are as level either will do
    assert browser.complaints() == []


def test_nothing_is_loaded_and_no_other_script_runs(pages, browser):
    browser.open(pages["paper_two"][2])
    assert browser.ask("performance.getEntriesByType('resource').length") == 0
    script = (
        "const one = document.createElement('script'); one.textContent = 'globalThis.mine = 1';"
    )
    browser.driver.execute_script(f"{script} document.body.append(one)")
    assert browser.ask("globalThis.mine") is None
    load = "fetch('data:,').then(() => arguments[0]('loaded'), () => arguments[0]('refused'))"
    assert browser.driver.execute_async_script(load) == "refused"
    assert len(browser.complaints()) >= 2


def test_every_control_moves_what_it_says(pages, browser):
    browser.open(pages["absolem"][2])
    move = (
        "((selector, value) => { const one = document.querySelector(selector); one.value = value;"
        "one.dispatchEvent(new Event('input', {bubbles: true}));"
        "one.dispatchEvent(new Event('change', {bubbles: true})); return true; })"
    )

    def moved(selector, value, what, expected):
        assert browser.ask(f"{move}({selector!r}, {value!r})")
        assert browser.ask(f"explorer.state.now{what}") == pytest.approx(expected), selector

    radians = math.radians
    moved("[id='range-p.front']", "36", "['p.front']", 36)
    moved("[id='range-p.rear']", "-72", "['p.rear']", -72)
    moved("[id='number-p.rear']", "10.5", "['p.rear']", 10.5)
    moved("[id='number-p.rear']", "500", "['p.rear']", 180)
    assert browser.ask("document.querySelector(\"[id='number-p.rear']\").value") == "180"
    browser.until(f"Math.abs(explorer.last.q[0] - {radians(36)}) < 1e-12")
    moved("#range-tilt", "12", ".tilt", 12)
    moved("#range-heading", "-40", ".heading", -40)
    moved("#range-mu", "0.1", ".mu", 0.1)
    moved("[name=x]", "rear", ".x", "rear")
    moved("[name=y]", "front", ".y", "front")
    moved("[name=what]", "sdg", ".what", "sdg")
    browser.until("document.querySelector('[data-is=slope]').textContent.endsWith('slides')")
    browser.driver.find_element("css selector", "[name=mode][value=body]").click()
    # In the body's frame gravity is what the sliders say; on the ground the robot is seated.
    down = math.sin(radians(12)) * math.cos(radians(-40))
    browser.until(f"Math.abs(explorer.last.g.x - {down}) < 1e-9")
    theme = "document.documentElement.style.colorScheme"
    before = browser.ask(theme)
    browser.press("d")
    assert browser.ask(theme) != before
    browser.press("l")
    assert browser.ask("explorer.state.now.tilt") == 0
    browser.press("r")
    assert browser.ask("['front', 'rear'].map((at) => explorer.state.now[`p.${at}`])") == [0, 0]
    assert browser.complaints() == []


def test_keys_and_drags_move_gravity(pages, browser):
    from selenium.webdriver import ActionChains, Keys

    browser.open(pages["absolem"][2])
    ActionChains(browser.driver).send_keys(Keys.ARROW_UP, Keys.ARROW_UP, Keys.ARROW_LEFT).perform()
    tilt = browser.ask("explorer.state.now.tilt")
    assert tilt == pytest.approx(math.hypot(2, 1), 1e-2)
    ActionChains(browser.driver).send_keys("l").perform()
    view = browser.driver.find_element("id", "view")
    across = view.size["width"] // 2
    for place, mode in (((-across + 60, 60), "ground"), ((0, 20), "body")):
        drag = ActionChains(browser.driver).move_to_element_with_offset(view, *place)
        drag.click_and_hold().move_by_offset(40, 20).release().perform()
        now = browser.ask("explorer.state.now")
        assert (now["mode"], now["tilt"] > 1) == (mode, True)
    camera = "explorer.stage.camera.position.toArray()"
    before, tilt = browser.ask(camera), browser.ask("explorer.state.now.tilt")
    drag = ActionChains(browser.driver).move_to_element_with_offset(view, 0, -200)
    drag.click_and_hold().move_by_offset(40, 20).release().perform()
    assert browser.ask(camera) != before
    assert browser.ask("explorer.state.now.tilt") == tilt
    disc = browser.driver.find_element("id", "disc")
    ActionChains(browser.driver).move_to_element_with_offset(disc, 30, 0).click().perform()
    browser.until("explorer.last.g.y < -0.1")
    plane = browser.driver.find_element("id", "map")
    ActionChains(browser.driver).move_to_element_with_offset(plane, 40, -30).click().perform()
    browser.until("explorer.last.q.every((x) => x > 0.1)")
    assert browser.complaints() == []


def test_pictures_are_not_blank_and_the_address_holds_the_state(pages, browser):
    state = "#p.alpha=40&p.gamma=20&mode=body&tilt=15&x=gamma&y=alpha&what=sdg&theme=dark"
    browser.open(pages["paper_two"][2], state)
    browser.until("explorer.disc.data?.size === 180 && explorer.map.data?.size === 61")
    browser.until("document.querySelector('[data-is=spoken]').textContent.includes('tipping')")
    for canvas, least in (("#view", 40), ("#disc", 12), ("#map", 12)):
        assert browser.driver.execute_script(COLOURS, canvas) >= least, canvas
    now = browser.ask("explorer.state.now")
    held = {"p.alpha": 40, "p.gamma": 20, "mode": "body", "tilt": 15, "heading": 0, "mu": ""}
    assert now == held | {"x": "gamma", "y": "alpha", "what": "sdg", "theme": "dark"}
    browser.press("l")
    browser.until("location.hash.includes('p.alpha=40&') && location.hash.includes('tilt=0&')")
    # Its recipe says nothing of friction, and neither does the page.
    assert browser.ask("document.querySelector('[data-is=slope]').textContent").endswith("°")
    assert browser.complaints() == []


def test_nothing_is_green_next_to_tipping(pages, browser):
    verdict = "document.querySelector('[data-is=verdict]')"
    for tilt, kind in ((30, "stands"), (45, "close"), (50, "tips")):
        browser.open(pages["paper_two"][2], f"#mode=body&tilt={tilt}&heading=60")
        browser.until(f"{verdict}.style.color === 'var(--{kind})'")


def test_a_page_that_is_damaged_says_so(pages, browser, tmp_path):
    path = tmp_path / "page.html"
    path.write_text(pages["paper_two"][2].read_text().replace('"wasm":"AGFzbQ', '"wasm":"AGFzbR'))
    browser.driver.get(path.as_uri())
    browser.until("!document.querySelector('#failed').hidden")
    assert "could not start" in browser.ask("document.querySelector('#failed').textContent")
