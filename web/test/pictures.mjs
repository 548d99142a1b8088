// node test/pictures.mjs ADDRESS FOLDER: what the page at ADDRESS shows once the gate can judge, as PNG (tools/page_pictures).
import { chromium } from "playwright-core";

const [address, folder] = process.argv.slice(2);
const kPatience_ms = 60000;
const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
await page.goto(address);
await page.waitForSelector('[data-sign="allowed"]', { timeout: kPatience_ms });
await page.screenshot({ path: `${folder}/page_walk.png` });
await page.click("#mode-3d");
await page.waitForTimeout(5000);
await page.screenshot({ path: `${folder}/page_3d.png` });
await page.click("#mode-3d");
await page.click("#tab-engineer");
await page.waitForSelector("#image-left:not([hidden])", { timeout: kPatience_ms });
await page.waitForTimeout(3000);
await page.screenshot({ path: `${folder}/page_engineer.png` });
await browser.close();
