// A flight of `sitl --view`: armed and taken off by keyboard, flown by sticks, broken by a button.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import test from "node:test";
import { ROOT, drawn, number, open, shoot, until } from "./browser.mjs";

const SCENARIO = join(ROOT, "sitl/scenarios/line-25.toml");

/** The simulator on a free instance and port; where its page is. */
async function serve(t, port, ...more) {
  const logs = mkdtempSync(join(tmpdir(), "tautline-view-"));
  const sitl = spawn(join(ROOT, "target/release/sitl"), [
    "--view", String(port), "--instance", "77", "--log-dir", logs, ...more,
  ], { stdio: ["ignore", "pipe", "inherit"] });
  t.after(() => {
    sitl.kill("SIGINT");
    return new Promise((done) => sitl.on("exit", () => {
      rmSync(logs, { recursive: true });
      done();
    }));
  });
  for await (const line of createInterface({ input: sitl.stdout })) {
    const url = line.match(/http:\S+/)?.[0];
    if (url) return url;
  }
  throw new Error("sitl named no address");
}

test("by keyboard it arms, takes off, moves by sticks and falls into a failsafe", { timeout: 240_000 }, async (t) => {
  const url = await serve(t, 18_765, "--speedup", "2");
  const { page, errors } = await open(url, t);
  await until(page, "armed", (shown) => shown === "ready");
  assert.ok((await drawn(page)) > 0.02, "the scene shows something");
  await page.keyboard.press("Space");
  await page.keyboard.press("KeyT");
  await until(page, "mode", (shown) => shown === "Takeoff");
  await until(page, "mode", (shown) => shown === "Tether Hold");
  const height = await number(page, "height");
  assert.ok(height > 4 && height < 6, `it holds at ${height} m`);
  await shoot(page, "live");

  await page.keyboard.press("KeyP");
  await until(page, "mode", (shown) => shown === "Position");
  await page.keyboard.down("KeyW");
  await until(page, "height", (shown) => Number.parseFloat(shown) > height + 1);
  await page.keyboard.up("KeyW");

  await page.select("#fault-kind", "altimeter_lost");
  await page.click("#fault button");
  await until(page, "texts", (shown) => shown.includes("Altimeter lost: descending"));
  await until(page, "texts", (shown) => shown.includes("Landed, disarmed"));
  assert.deepEqual(errors, []);
});

test("a chain flies and is drawn on a telephone too", { timeout: 120_000 }, async (t) => {
  const url = await serve(t, 18_766, "--headless", "--scenario", SCENARIO, "--speedup", "5");
  const { page, errors } = await open(url, t, { width: 390, height: 844 });
  await until(page, "armed", (shown) => shown === "flying");
  assert.ok((await drawn(page)) > 0.02);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `nothing sticks out: ${wide} pixels`);
  await shoot(page, "phone");
  assert.deepEqual(errors, []);
});
