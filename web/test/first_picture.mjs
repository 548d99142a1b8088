// node test/first_picture.mjs ADDRESS TIMES: milliseconds from the call of the address to the first ground that is drawn, a line
// each, in a fresh Chromium profile (tools/page_load), which draws as it does where there is no graphics card.
import { chromium } from "playwright-core";

const [address, times] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--disable-gpu", "--no-sandbox"] });

// The page's own clock: whoever asks from outside hears of it half a second later on a busy machine.
function noteFirstGround() {
  const look = () => {
    if (document.documentElement?.dataset.ground !== "fresh") return;
    observer.disconnect();
    // That frame is on the screen when the next one begins.
    const note = () => (globalThis.drawn_at_ms = performance.timeOrigin + performance.now());
    requestAnimationFrame(() => requestAnimationFrame(note));
  };
  const observer = new MutationObserver(look);
  observer.observe(document, { attributes: true, subtree: true, attributeFilter: ["data-ground"] });
}

for (let i = 0; i < Number(times); ++i) {
  const page = await (await browser.newContext()).newPage();
  await page.addInitScript(noteFirstGround);
  const began_ms = performance.timeOrigin + performance.now();
  await page.goto(address);
  const drawn_at_ms = await (await page.waitForFunction(() => globalThis.drawn_at_ms)).jsonValue();
  console.log(Math.round(drawn_at_ms - began_ms));
  await page.close();
}
await browser.close();
