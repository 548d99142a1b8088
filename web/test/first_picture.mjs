// node test/first_picture.mjs ADDRESS TIMES: milliseconds from the call of the address to the first ground that is drawn, a line
// each, in a fresh Chromium profile (tools/page_load).
import { chromium } from "playwright-core";

const [address, times] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
});
for (let i = 0; i < Number(times); ++i) {
  const page = await (await browser.newContext()).newPage();
  const began_ms = performance.now();
  await page.goto(address);
  await page.waitForSelector("html[data-ground=fresh]");
  // That frame is on the screen when the next one begins.
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  console.log(Math.round(performance.now() - began_ms));
  await page.close();
}
await browser.close();
