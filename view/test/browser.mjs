// Debian's chromium without a window, and what a person reads on the page.

import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { launch } from "puppeteer-core";

export const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../..");
const SHOTS = join(ROOT, "target/view/shots");

export async function open(url, test, viewport = { width: 1280, height: 800 }) {
  const browser = await launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    defaultViewport: viewport,
  });
  test.after(() => browser.close());
  const page = await browser.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  await page.goto(url);
  return { page, errors };
}

export const text = (page, id) => page.$eval(`#${id}`, (found) => found.textContent);
export const number = async (page, id) => Number.parseFloat(await text(page, id));

/** Until the page shows it; what it shows instead stands in the failure. */
export async function until(page, id, is, seconds = 120) {
  const end = Date.now() + seconds * 1000;
  let shown;
  while (Date.now() < end) {
    shown = await text(page, id);
    if (is(shown)) return shown;
    await new Promise((done) => setTimeout(done, 100));
  }
  const texts = await text(page, "texts");
  assert.fail(`#${id} still shows ${JSON.stringify(shown)}; texts: ${texts}`);
}

/** Pixels of the scene that are not the sky, as a share. */
export async function drawn(page) {
  const frame = await page.$eval("#scene", (canvas) => {
    const box = canvas.getBoundingClientRect();
    return { x: box.x, y: box.y, width: box.width, height: box.height };
  });
  const picture = await page.screenshot({ clip: frame, encoding: "base64" });
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const pen = canvas.getContext("2d");
    pen.drawImage(image, 0, 0);
    const { data: rgba } = pen.getImageData(0, 0, image.width, image.height);
    // The top right corner is free of everything but sky.
    const sky = 4 * (image.width - 3) + 4 * image.width * 2;
    let other = 0;
    for (let i = 0; i < rgba.length; i += 4) {
      const apart = [0, 1, 2].reduce((sum, c) => sum + Math.abs(rgba[i + c] - rgba[sky + c]), 0);
      if (apart > 30) other += 1;
    }
    return (4 * other) / rgba.length;
  }, picture);
}

export async function shoot(page, name) {
  mkdirSync(SHOTS, { recursive: true });
  await page.screenshot({ path: join(SHOTS, `${name}.png`) });
}
