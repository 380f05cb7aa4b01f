#!/usr/bin/env python3
"""Looks at a report's page in headless Chromium, as a reader would.

    browser_check.py DLO SCENE... [--screenshots FOLDER] [--report FOLDER]
                     [--chromedriver PATH]

Makes a quick report of the scenes with the command DLO (or takes a finished one) and checks at 375,
400, 800, 1280 and 1920 pixels, in light and in dark: no console message, no request but for the
page itself, every figure there, of some size and within the page, nothing that makes the page
scroll sideways, text that stands out from its ground, less than 3 MB, all with every section
open. Sections have to be folded at first, opened by the contents, and all open on paper. Then it uses
what the page's script offers (interaction.py), at 400 and 1280 pixels. With --screenshots it leaves pictures of all
of them, and of the page as it is printed.
"""
import argparse
import base64
import json
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile

try:
    from interaction import interactions
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ModuleNotFoundError:
    print("python3-selenium is not installed")
    sys.exit(77)  # skipped

WIDTHS = (375, 400, 800, 1280, 1920)
USED_AT = (400, 1280)
HEIGHT = 900
SCHEMES = ("light", "dark")
LARGEST = 3_000_000  # bytes

# Every figure's box, what is wider than the page, and the contrast of texts on their ground.
MEASURE = """
for (const fold of document.querySelectorAll('details')) fold.open = true;
const box = e => e.getBoundingClientRect();
const rgb = c => (c.match(/[0-9.]+/g) || []).map(Number);
const luminance = c => {
  const part = v => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  return 0.2126 * part(c[0]) + 0.7152 * part(c[1]) + 0.0722 * part(c[2]);
};
const ground = e => {
  for (; e; e = e.parentElement) {
    const c = rgb(getComputedStyle(e).backgroundColor);
    if (c.length === 3 || c[3] > 0) return c;
  }
  return [255, 255, 255];
};
const contrast = e => {
  const [a, b] = [luminance(rgb(getComputedStyle(e).color)), luminance(ground(e))];
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
};
const figures = [...document.querySelectorAll('figure')].map(f => {
  const svg = f.querySelector('svg');
  const b = svg ? box(svg) : {width: 0, height: 0, left: 0, right: 0};
  const texts = svg ? [...svg.querySelectorAll('text')].filter(t => t.textContent.trim()) : [];
  return {id: f.id, width: b.width, height: b.height, left: b.left, right: b.right,
          visible: !!svg && getComputedStyle(svg).visibility === 'visible',
          role: svg && svg.getAttribute('role'),
          title: svg && svg.querySelector('title') ? svg.querySelector('title').textContent : '',
          shapes: svg ? svg.querySelectorAll('path, use').length : 0,
          outside: texts.filter(t => box(t).left < b.left - 1 || box(t).right > b.right + 1 ||
                                     box(t).top < b.top - 1 || box(t).bottom > b.bottom + 1)
                        .map(t => t.textContent),
          smallest: Math.min(...texts.map(t => box(t).height))};
});
const ids = [...document.querySelectorAll('[id]')].map(e => e.id);
const pale = [...document.querySelectorAll('p, li, td, th, caption, figcaption, code, a, h1, h2')]
  .map(e => [contrast(e), e.textContent.slice(0, 40)]).filter(([c]) => c < 4.5);
return {figures, pale, width: document.documentElement.clientWidth,
        scroll: document.documentElement.scrollWidth,
        twice: ids.filter((id, i) => ids.indexOf(id) !== i)};
"""


def open_browser(chromedriver):
    options = webdriver.ChromeOptions()
    for argument in ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(chromedriver), options=options)


def set_view(browser, width, scheme, media=""):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": HEIGHT, "deviceScaleFactor": 1,
                             "mobile": width < 600})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                            {"media": media,
                             "features": [{"name": "prefers-color-scheme", "value": scheme}]})


def screenshot(browser, path):
    picture = browser.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
    path.write_bytes(base64.b64decode(picture["data"]))


def requests_of(browser):
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            yield message["params"]["request"]["url"]


def problems_of(seen):
    if seen["scroll"] > seen["width"]:
        yield f"the page is {seen['scroll']} wide"
    if not seen["figures"]:
        yield "no figure"
    for twice in seen["twice"]:
        yield f"two elements are called {twice}"
    for contrast, text in seen["pale"]:
        yield f"contrast {contrast:.2f} of '{text}'"
    for figure in seen["figures"]:
        name = figure["id"]
        if not figure["visible"] or figure["width"] < 250 or figure["height"] < 100:
            yield f"{name} is {figure['width']} x {figure['height']}"
        if figure["left"] < 0 or figure["right"] > seen["width"]:
            yield f"{name} leaves the page"
        if figure["role"] != "img" or not figure["title"]:
            yield f"{name} has no name for those who do not see it"
        if figure["shapes"] < 10:
            yield f"{name} is empty"
        if figure["outside"]:
            yield f"{name}: texts outside of it: {figure['outside']}"
        if figure["smallest"] < 10:
            yield f"{name}: text {figure['smallest']:.1f} pixels high"


def looks(browser, page, screenshots):
    """What is wrong with a page at all widths, light and dark."""
    size = page.stat().st_size
    problems = [f"the page has {size} bytes"] if size >= LARGEST else []
    browser.execute_cdp_cmd("Network.enable", {})
    list(requests_of(browser))  # those of another page
    for width in WIDTHS:
        for scheme in SCHEMES:
            set_view(browser, width, scheme)
            browser.get(page.as_uri())
            where = f"{width} {scheme}"
            seen = browser.execute_script(MEASURE)
            problems += [f"{where}: {problem}" for problem in problems_of(seen)]
            for url in requests_of(browser):
                if url != page.as_uri() and not url.startswith("data:"):
                    problems.append(f"{where}: request of {url}")
            problems += [f"{where}: console: {entry['message']}"
                         for entry in browser.get_log("browser")]
            if screenshots:
                screenshot(browser, screenshots / f"{page.stem}_{width}_{scheme}.png")
    return problems


def first_screen(browser, page):
    """What somebody who only opens a page does not see: the badge, the cause, the numbers, the picture."""
    for width in (1280, 1920):
        set_view(browser, width, "light")
        browser.get(page.as_uri())
        for what in (".badge", ".three", "figure:first-of-type svg", "h1"):
            below = browser.execute_script(
                "return [...document.querySelectorAll(arguments[0])].map("
                "e => e.getBoundingClientRect().bottom)", what)
            if len(below) != 1 or below[0] > HEIGHT:
                yield f"{page.name} at {width}: {what}: {len(below)}, down to {below}"


def check_shape_pages(dlo, folder, chromedriver, screenshots):
    """The pages of a shape that passes, and of one that fails."""
    data = pathlib.Path(__file__).resolve().parents[2] / "data"
    problems = []
    browser = open_browser(chromedriver)
    try:
        for model, tolerance in (("chain", "5%"), ("force", "0.01%")):
            scene = data / "scenes" / "cable.toml"
            shape = folder / f"{model}.csv"
            page = folder / f"{model}.html"
            subprocess.run([dlo, "solve", str(scene), "--model", model, "--points", "24",
                            "--format", "csv", "-o", str(shape)], check=True)
            status = subprocess.run([dlo, "check", str(scene), "--shape", str(shape), "--tolerance",
                                     tolerance, "--report", str(page)],
                                    stdout=subprocess.DEVNULL, check=False).returncode
            if status not in (0, 1):
                return [f"dlo check --report: status {status}"]
            problems += [f"{page.name}: {problem}" for problem in looks(browser, page, screenshots)]
            problems += list(first_screen(browser, page))
            badge = browser.execute_script("return document.querySelector('.badge').textContent")
            if badge.split()[-1] != ("pass", "fail")[status]:
                problems.append(f"{page.name}: badge {badge}, status {status}")
    finally:
        browser.quit()
    return problems


def folds(browser, page):
    """Sections below the first screen wait until they are asked for, by the contents or by paper."""
    def closed():
        return browser.execute_script(
            "return [...document.querySelectorAll('details.section:not([open])')]"
            ".map(fold => fold.parentElement.id)")

    browser.get(page.as_uri())
    sections = closed()
    if "shapes" not in sections or "provenance" not in sections or "verdict" in sections:
        yield f"folded at first are {sections}"
    for section in sections:
        # Folded and at its top again, as it was loaded.
        browser.execute_script(
            "document.querySelectorAll('details.section').forEach("
            "fold => { if (arguments[1].includes(fold.parentElement.id)) fold.open = false; });"
            "scrollTo(0, 0); document.querySelector(`nav a[href='#${arguments[0]}']`).click()",
            section, sections)
        if closed() != [other for other in sections if other != section]:
            yield f"the contents' {section} leave closed {closed()}"
        top = browser.execute_script(
            "return document.getElementById(arguments[0]).getBoundingClientRect().top", section)
        if not -1 <= top <= HEIGHT:
            yield f"the contents' {section} lead to {top}"
    browser.get("about:blank")
    browser.get(page.as_uri() + "#budget")
    if "budget" in closed():
        yield "an address with #budget does not open it"
    browser.execute_script(
        "addEventListener('beforeprint', () => { window.closedOnPaper ="
        " document.querySelectorAll('details:not([open])').length; })")
    # One page of it: what opens and closes does so for all of them.
    browser.execute_cdp_cmd("Page.printToPDF", {"pageRanges": "1"})
    on_paper = browser.execute_script("return window.closedOnPaper")
    if on_paper != 0:
        yield f"closed on paper: {on_paper}"
    if len(closed()) != len(sections) - 1:
        yield f"after printing closed are {closed()}"


def check(page, chromedriver, screenshots):
    browser = open_browser(chromedriver)
    try:
        problems = looks(browser, page, screenshots)
        for width in USED_AT:
            set_view(browser, width, "light")
            problems += [f"{width} folded: {problem}" for problem in folds(browser, page)]
            problems += [f"{width} used: {problem}"
                         for problem in interactions(browser, page.as_uri())]
            problems += [f"{width} used: console: {entry['message']}"
                         for entry in browser.get_log("browser")]
        if screenshots:
            set_view(browser, 720, "light", "print")
            screenshot(browser, screenshots / "print.png")
            pdf = browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})
            (screenshots / "print.pdf").write_bytes(base64.b64decode(pdf["data"]))
    finally:
        browser.quit()
    return problems


def has_localhost():
    """A bare chroot has no /etc/hosts, and selenium asks for chromedriver by that name."""
    try:
        socket.getaddrinfo("localhost", None)
    except OSError:
        return False
    return True


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("dlo")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--chromedriver", default="/usr/bin/chromedriver")
    parser.add_argument("--report", type=pathlib.Path)
    parser.add_argument("--screenshots", type=pathlib.Path)
    options = parser.parse_args()
    if not options.report and not shutil.which("gnuplot"):
        print("gnuplot is not installed: there would be no figures to look at")
        return 77  # skipped
    if not has_localhost():
        print("localhost is not known here: chromedriver cannot be talked to")
        return 77  # skipped
    if options.screenshots:
        options.screenshots.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        report = options.report
        if not report:
            report = pathlib.Path(folder) / "report"
            subprocess.run([options.dlo, "report", *options.scenes, "--quick", "-o", str(report)],
                           check=True, stdout=subprocess.DEVNULL)
        problems = check((report / "index.html").resolve(), options.chromedriver,
                         options.screenshots)
        problems += check_shape_pages(options.dlo, pathlib.Path(folder), options.chromedriver,
                                      options.screenshots)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
