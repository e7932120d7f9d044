#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens a report in headless Chromium, at 375 and 1440 pixels, light and dark.

usage: browser_test.py report.html [SCREENSHOTS]

Fails on a console message, a picture that does not load or has no description, anything wider than
the window, a table that the keyboard cannot reach, or a slider that does not move. Exits with 77
when no Chromium is installed (Debian: chromium-headless-shell or chromium). With a folder it leaves
a screenshot of each form there.
"""
import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# Runs inside the page once it is loaded, and leaves its findings where --dump-dom shows them.
PROBE = """
<script>
addEventListener('load', () => {
  const problems = [];
  const say = (text) => problems.push(text);
  for (const image of document.images) {
    if (!image.complete || image.naturalWidth === 0) say('a picture does not load: ' + image.alt);
    if (!image.alt) say('a picture has no description');
  }
  for (const plot of document.querySelectorAll('svg')) {
    if (!plot.getAttribute('aria-label')) say('a plot has no description');
    const frame = plot.getBoundingClientRect();
    const texts = [...plot.querySelectorAll('text')].map(
        (text) => ({says: text.textContent, box: text.getBoundingClientRect()}));
    texts.forEach(({says, box}, i) => {
      if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 ||
          box.bottom > frame.bottom + 1) {
        say('in a plot is cut off: ' + says);
      }
      for (const other of texts.slice(i + 1)) {
        const wide = Math.min(box.right, other.box.right) - Math.max(box.left, other.box.left);
        const high = Math.min(box.bottom, other.box.bottom) - Math.max(box.top, other.box.top);
        if (wide > 1 && high > 3) say('in a plot lie on each other: ' + says + ', ' + other.says);
      }
    });
  }
  const width = document.documentElement.clientWidth;
  for (const element of document.querySelectorAll('main > *, figure > *, p, pre')) {
    if (element.getBoundingClientRect().right > width + 1) {
      say(element.tagName + ' reaches beyond the window: ' + element.textContent.slice(0, 40));
    }
  }
  if (document.documentElement.scrollWidth > width + 1) say('the page scrolls sideways');
  for (const box of document.querySelectorAll('.scroll')) {
    box.focus();
    if (document.activeElement !== box) say('the keyboard does not reach a table');
  }
  for (const slider of document.querySelectorAll('input[type=range]')) {
    if (!slider.getAttribute('aria-label')) say('a slider has no name');
    slider.focus();
    if (document.activeElement !== slider) say('the keyboard does not reach a slider');
    slider.value = 80;
    slider.dispatchEvent(new Event('input', {bubbles: true}));
    const at = slider.previousElementSibling.style.getPropertyValue('--at');
    if (at !== '80%') say('a slider does not move its pictures');
    slider.value = 50;
    slider.dispatchEvent(new Event('input', {bubbles: true}));
  }
  let level = 1;
  for (const heading of document.querySelectorAll('h1,h2,h3')) {
    const next = Number(heading.tagName[1]);
    if (next > level + 1) say('headings skip a level: ' + heading.textContent);
    level = next;
  }
  document.activeElement.blur();
  scrollTo(0, 0);
  const findings = {problems, pictures: document.images.length, width: innerWidth,
                    plots: document.querySelectorAll('svg').length,
                    paper: getComputedStyle(document.body).backgroundColor};
  parent.postMessage(JSON.stringify(findings), '*');
});
</script>
"""

# A window cannot be narrower than some 500 pixels; a frame can.
FRAME = """<!doctype html><html><body style="margin:0">
<iframe src="page.html" style="border:0;width:{width}px;height:{height}px"></iframe>
<script>
addEventListener('message', (event) => {{
  const findings = document.createElement('pre');
  findings.id = 'findings';
  findings.hidden = true;
  findings.textContent = event.data;
  document.body.append(findings);
}});
</script></body></html>
"""


def find_browser():
    for name in ("chromium-headless-shell", "chromium"):
        path = shutil.which(name)
        if path:
            return path
    return None


def run_browser(browser, page, width, height, dark, arguments):
    command = [
        browser,
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
        "--enable-logging=stderr",
        "--log-level=0",
        "--virtual-time-budget=10000",
        f"--window-size={max(width, 500)},{height}",
        f"--user-data-dir={page.parent / 'profile'}",
    ]
    if dark:
        command.append("--blink-settings=preferredColorScheme=0")
    result = subprocess.run(
        command + arguments + [page.as_uri()], capture_output=True, text=True, timeout=120, check=False
    )
    if result.returncode != 0:
        sys.exit(f"the browser ended with {result.returncode}: {result.stderr[-2000:]}")
    return result


def open_at(browser, report, width, dark, screenshots):
    problems = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "page.html").write_text(report.replace("</body>", PROBE + "</body>"), "utf-8")
        page = folder / "frame.html"
        page.write_text(FRAME.format(width=width, height=1500), "utf-8")
        result = run_browser(browser, page, width, 1500, dark, ["--dump-dom"])
        problems += [line for line in result.stderr.splitlines() if ":CONSOLE" in line]
        found = re.search(r'<pre id="findings"[^>]*>(.*?)</pre>', result.stdout, re.S)
        if found is None:
            sys.exit(f"the page at {width} pixels told nothing; did its scripts run?")
        findings = json.loads(html.unescape(found.group(1)))
        problems += findings["problems"]
        if findings["width"] != width:
            problems.append(f"the page is {findings['width']} pixels wide")
        if screenshots:
            name = f"report_{width}_{'dark' if dark else 'light'}.png"
            run_browser(browser, page, width, 1500, dark, [f"--screenshot={screenshots / name}"])
    return problems, findings


def main():
    browser = find_browser()
    if browser is None:
        print("no Chromium is installed: skipped")
        return 77
    report = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")
    screenshots = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    failed = False
    papers = set()
    for width in (375, 1440):
        for dark in (False, True):
            problems, findings = open_at(browser, report, width, dark, screenshots)
            papers.add(findings["paper"])
            print(
                f"{width} pixels, {'dark' if dark else 'light'}: {findings['pictures']} pictures, "
                f"{findings['plots']} plots, {len(problems)} problems"
            )
            for problem in problems:
                print("  " + problem)
            failed = failed or bool(problems) or findings["plots"] == 0
    if len(papers) != 2:
        print("light and dark have the same paper")
        failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
