"""Uses what a report's page offers beside reading, by mouse and by keyboard, and holds what it then
shows against the numbers in the page."""
import json
import re

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

TURN_OF_KEY = 5  # degrees


class Page:
    """The section with the script's parts, in a browser that has loaded the report."""

    def __init__(self, browser):
        self.browser = browser
        self.data = json.loads(self.find("page-data").get_attribute("textContent"))

    def find(self, identifier):
        return self.browser.find_element(By.ID, identifier)

    def text(self, identifier):
        return self.find(identifier).text

    def curve(self, index, stage="view-stage"):
        """Where the points of a drawn curve are, in pixels of its picture."""
        path = self.browser.find_element(By.CSS_SELECTOR, f"#{stage} path.curve.c{index}")
        return [tuple(map(float, pair)) for pair in re.findall(r"[ML]([-\d.]+),([-\d.]+)",
                                                               path.get_attribute("d"))]

    def press(self, element, *keys):
        element.send_keys(*keys)

    def focused(self):
        return self.browser.switch_to.active_element.get_attribute("id")


def shown(value, digits=4):
    """A number as the page writes it."""
    return float(f"{value:.{digits}g}")


def has_number(text, before, value, digits=4):
    found = re.search(re.escape(before) + r"(-?[\d.]+(?:e[-+]?\d+)?)", text)
    return found is not None and abs(float(found[1]) - shown(value, digits)) <= 1e-9 + 1e-9 * abs(value)


def without_script(browser, url):
    """The page as it is where scripts do not run."""
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    browser.get(url)
    document = browser.execute_cdp_cmd("DOM.getDocument", {})["root"]["nodeId"]
    for identifier, visible in (("interactive", False), ("shapes", True)):
        node = browser.execute_cdp_cmd("DOM.querySelector",
                                       {"nodeId": document, "selector": "#" + identifier})
        try:
            browser.execute_cdp_cmd("DOM.getBoxModel", {"nodeId": node["nodeId"]})
            seen = True
        except Exception:  # "Could not compute box model", a plain WebDriverException
            seen = False
        if seen != visible:
            yield f"without scripts #{identifier} is {'there' if seen else 'not there'}"
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def reachable_by_tab(page):
    wanted = {"view-scene", "view-stage", "grid-gamma", "grid-angle", "grid-points", "grid-law"}
    page.find("view-scene").click()
    page.press(page.find("view-scene"), Keys.ESCAPE)
    reached = {page.focused()}
    for _ in range(20):
        ActionChains(page.browser).send_keys(Keys.TAB).perform()
        reached.add(page.focused())
    for identifier in sorted(wanted - reached):
        yield f"#{identifier} is not reached by the tabulator"


def along_by_keyboard(page):
    """Each key says the numbers of the point that it goes to."""
    stage = page.find("view-stage")
    for number, scene in enumerate(page.data["scenes"]):
        Select(page.find("view-scene")).select_by_index(number)
        rod, polygon = scene["curves"][0], scene["curves"][1]
        page.press(stage, Keys.HOME)
        if not has_number(page.text("view-readout"), "s = ", rod["s"][0]):
            yield f"{scene['name']}: Home shows {page.text('view-readout')}"
        page.press(stage, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        text = page.text("view-readout")
        if not (has_number(text, "s = ", rod["s"][4]) and
                has_number(text, "curvature ", rod["curvature"][4]) and
                ("tension" not in rod or has_number(text, "tension ", rod["tension"][4]))):
            yield f"{scene['name']}: two steps along the rod show {text}"
        page.press(stage, Keys.ARROW_DOWN, Keys.END)
        text = page.text("view-readout")
        if not (polygon["name"] in text and has_number(text, "s = ", polygon["s"][-1]) and
                has_number(text, f"{'m, '}", 1e3 * polygon["distance"][-1])):
            yield f"{scene['name']}: the end of the polygon shows {text}"


def hover(page, index, x, y):
    """Points at a place of the picture [pixels]."""
    svg = page.browser.find_element(By.CSS_SELECTOR, "#view-stage svg")
    page.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", svg)
    box = page.browser.execute_script(
        "const b = arguments[0].getBoundingClientRect(); return [b.left, b.top]", svg)
    actions = ActionChains(page.browser)
    actions.w3c_actions.pointer_action.move_to_location(int(box[0] + x), int(box[1] + y))
    actions.perform()


def along_by_mouse(page):
    for number, scene in enumerate(page.data["scenes"]):
        Select(page.find("view-scene")).select_by_index(number)
        curve = len(scene["curves"]) - 1
        at = len(scene["curves"][curve]["s"]) // 2
        hover(page, curve, *page.curve(curve)[at])
        mark = page.browser.find_element(By.CSS_SELECTOR, "#view-stage .mark")
        away = [abs(float(mark.get_attribute(name)) - expected)
                for name, expected in zip(("cx", "cy"), page.curve(curve)[at])]
        text = page.text("view-readout")
        # Another shape may be as near.
        if max(away) > 3 or "s = " not in text:
            yield f"{scene['name']}: the mark is {max(away)} pixels from the pointer, and says {text}"


def turned(page):
    """A quarter turn shows the depth of the shape as its width, a whole turn is none."""
    spatial = [i for i, scene in enumerate(page.data["scenes"]) if scene["spatial"]]
    if not spatial:
        yield "no scene in space to turn"
        return
    scene = page.data["scenes"][spatial[0]]
    Select(page.find("view-scene")).select_by_index(spatial[0])
    stage = page.find("view-stage")
    first = page.curve(0)

    def apart(points):
        return max(max(abs(a - b) for a, b in zip(p, q)) for p, q in zip(points, first))

    def width(points):
        return max(p[0] for p in points) - min(p[0] for p in points)

    def extent(axis):
        values = scene["curves"][0]["xyz"[axis]]
        return max(values) - min(values)

    right, up = scene["view"]
    quarter = 90 // TURN_OF_KEY
    for turn in range(4):
        page.press(stage, (Keys.SHIFT + Keys.ARROW_RIGHT + Keys.SHIFT) * quarter)
        if turn == 0:
            expected = width(first) * extent(3 - right - up) / extent(right)
            if abs(width(page.curve(0)) - expected) > 1:
                yield f"turned by a quarter the shape is {width(page.curve(0))} wide, not {expected}"
    if apart(page.curve(0)) > 0.2:
        yield f"a whole turn moves the shape by {apart(page.curve(0))} pixels"
    page.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", stage)
    ActionChains(page.browser).drag_and_drop_by_offset(stage, 60, 20).perform()
    if apart(page.curve(0)) < 5:
        yield "dragging does not turn the shape"
    page.press(stage, "0")
    if apart(page.curve(0)) > 0.2:
        yield "0 does not turn the shape back"
    page.browser.find_element(By.CSS_SELECTOR, "button[aria-label='turn right']").click()
    if apart(page.curve(0)) < 5:
        yield "the button does not turn the shape"


def slide_to(page, identifier, value):
    page.browser.execute_script(
        "arguments[0].value = arguments[1];"
        "arguments[0].dispatchEvent(new Event('input', {bubbles: true}))",
        page.find(identifier), value)


def slid(page):
    """Sliders by keyboard and otherwise: the readout has the numbers of the nearest cell."""
    grid = page.data["grid"]
    sizes = [len(grid[name]) for name in ("gammas", "angles_deg", "points", "models")]

    def expect(place, what):
        index = 0
        for size, at in zip(sizes, place):
            index = index * size + at
        cell = grid["cells"][index]
        text = page.text("grid-readout")
        names = (f"Γ = {grid['gammas'][place[0]]:g}, clamp at {grid['angles_deg'][place[1]]:g}°, "
                 f"N = {grid['points'][place[2]]}, law {grid['models'][place[3]]['law']}")
        numbers = ("not computed: " + cell["failure"][:40] in text if "failure" in cell else
                   has_number(text, "consistent: " if place[3] else "paper: ", 100 * cell["rms"], 3))
        if names not in text or not numbers:
            return [f"{what}: {names} shows {text}"]
        if "failure" not in cell and len(page.curve(1, "grid")) != 2 * len(cell["s"]) and (
                len(page.curve(1, "grid")) != len(cell["s"])):
            return [f"{what}: {len(page.curve(1, 'grid'))} points"]
        return []

    for identifier in ("grid-gamma", "grid-angle", "grid-points"):
        page.press(page.find(identifier), Keys.HOME)
    yield from expect((0, 0, 0, 0), "Home")
    for identifier in ("grid-gamma", "grid-angle", "grid-points"):
        page.press(page.find(identifier), Keys.END)
    page.press(page.find("grid-law"), Keys.ARROW_DOWN)
    yield from expect([size - 1 for size in sizes], "End")
    page.press(page.find("grid-points"), Keys.ARROW_LEFT)
    if "→" not in page.find("grid-points").find_element(By.XPATH, "following-sibling::*").text:
        yield "between two values it is not said that the nearest is shown"
    yield from expect([size - 1 for size in sizes], "the nearest")
    failed = [i for i, cell in enumerate(grid["cells"]) if "failure" in cell][:1]
    for index in failed:
        place = []
        for size in reversed(sizes):
            index, at = divmod(index, size)
            place.insert(0, at)
        slide_to(page, "grid-gamma", page.browser.execute_script(
            "return Math.log10(arguments[0])", grid["gammas"][place[0]]))
        slide_to(page, "grid-angle", grid["angles_deg"][place[1]])
        slide_to(page, "grid-points", grid["points"][place[2]])
        Select(page.find("grid-law")).select_by_index(place[3])
        yield from expect(place, "a cell without shapes")


def interactions(browser, url):
    """What does not do what it should."""
    yield from without_script(browser, url)
    browser.get(url)
    page = Page(browser)
    for check in (reachable_by_tab, along_by_keyboard, along_by_mouse, turned, slid):
        yield from check(page)
