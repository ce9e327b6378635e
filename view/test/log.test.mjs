// A log that the simulator has written, dropped into the page and scrubbed by keys.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";
import { ROOT, drawn, number, open, shoot, text, until } from "./browser.mjs";

test("a log is scrubbed by keys and played", { timeout: 180_000 }, async (t) => {
  const folder = mkdtempSync(join(tmpdir(), "tautline-view-"));
  t.after(() => rmSync(folder, { recursive: true }));
  const scenario = join(ROOT, "sitl/scenarios/gusts-3.toml");
  execFileSync(join(ROOT, "target/release/sitl"), ["--headless", "--scenario", scenario, "--log-dir", folder], { stdio: "ignore" });
  const { page, errors } = await open(pathToFileURL(join(ROOT, "sitl/src/view/page.html")).href, t);
  const input = await page.$("#file");
  await input.uploadFile(join(folder, "flight-0001.ulg"));
  await until(page, "source", (shown) => shown.startsWith("log"));

  assert.equal(await text(page, "time"), "0.0");
  const ground = await number(page, "height");
  for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
  assert.equal(await text(page, "time"), "5.0");
  await page.keyboard.down("Shift");
  for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.up("Shift");
  assert.equal(await text(page, "time"), "45.0");
  const height = await number(page, "height");
  assert.ok(height > ground + 4 && height < 6, `from ${ground} to ${height} m`);
  assert.equal(await text(page, "mode"), "Tether Hold");
  assert.equal(await text(page, "armed"), "flying");
  assert.ok((await drawn(page)) > 0.02);

  await page.keyboard.press("Space");
  await until(page, "time", (shown) => Number(shown) > 46);
  await page.keyboard.press("Space");
  await page.waitForFunction(() => !document.getElementById("note").classList.contains("shown"));
  await shoot(page, "log");
  await page.keyboard.press("End");
  assert.ok((await number(page, "height")) < 0.5, "it has landed");
  assert.equal(await text(page, "armed"), "ready");
  assert.deepEqual(errors, []);
});

test("what is no log is refused in one line", { timeout: 60_000 }, async (t) => {
  const { page } = await open(pathToFileURL(join(ROOT, "sitl/src/view/page.html")).href, t);
  const input = await page.$("#file");
  await input.uploadFile(join(ROOT, "LICENSE-MIT"));
  assert.equal(await until(page, "note", (shown) => shown.includes("no ULog")), "LICENSE-MIT is no ULog file");
});
