// Simulator and firmware in the page, opened from the disk: no server at all.

import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";
import { ROOT, drawn, number, open, shoot, until } from "./browser.mjs";

const PAGE = pathToFileURL(join(ROOT, "target/view/index.html")).href;
/** Simulated per real seconds, at least. */
const FASTEST = 5;
/** s. */
const MEASURED = 5;

test("it flies by keyboard, and much faster than real time", { timeout: 240_000 }, async (t) => {
  const { page, errors } = await open(PAGE, t);
  await page.select("#speed", "5");
  await until(page, "armed", (shown) => shown === "ready");
  await page.keyboard.press("Space");
  await page.keyboard.press("KeyT");
  await until(page, "texts", (shown) => shown.includes("Take-off complete"));
  assert.ok((await number(page, "height")) > 4);
  assert.ok((await drawn(page)) > 0.02);
  await shoot(page, "wasm");
  await page.keyboard.press("KeyL");
  await until(page, "mode", (shown) => shown === "Land");
  await until(page, "armed", (shown) => shown === "ready");
  await page.select("#speed", "1000");
  const began = await number(page, "time");
  const ended = await new Promise((done) => setTimeout(() => done(number(page, "time")), MEASURED * 1000));
  const factor = (ended - began) / MEASURED;
  assert.ok(factor >= FASTEST, `${factor}`);
  t.diagnostic(`${factor.toFixed(0)} simulated seconds per second, in a browser that draws by software`);
  assert.deepEqual(errors, []);
});

test("a click on a row of the failsafe table flies it to its end", { timeout: 240_000 }, async (t) => {
  const { page, errors } = await open(PAGE, t);
  await page.waitForSelector("#failsafes button");
  const ends = (part) => page.waitForFunction((part) => {
    const rows = [...document.querySelectorAll("#failsafes tr")];
    return rows.some((row) => row.textContent.includes(part) && row.cells[2].textContent.includes("on the ground"));
  }, { timeout: 120_000 }, part);
  await page.$$eval("#failsafes button", (all) => all.find((one) => one.textContent.startsWith("Altimeter lost")).click());
  await ends("Altimeter lost");
  const shown = await page.$$eval("#failsafes tr", (rows) => rows.find((row) => row.textContent.includes("Altimeter lost")).cells[2].textContent);
  assert.match(shown, /Descent → on the ground, down at [\d.]+ m\/s after \d+ s$/);
  assert.deepEqual(errors, []);
});
