// Opens every page of the built site in a headless Chromium, at the widths of a desk and a phone: node .ci/browser.mjs SITE [PICTURES]
//
// A fault is: a message of an error on the console, a request that leaves the machine, a picture that does not show, a page that is
// wider than the phone, or a search that finds nothing. With PICTURES, a picture of each page is written into that folder.
// The site is served on 127.0.0.1. It needs Node 20 or newer and Chromium; CHROMIUM in the environment names the program.
import { spawn } from "node:child_process";
import { createReadStream, existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join, resolve, sep } from "node:path";

const WIDTHS = { desk: 1280, phone: 390 };
const SEARCHES = ["allan", "kalibr", "tunnel"];
const KINDS = { ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml", ".png": "image/png" };
const [site, pictures] = process.argv.slice(2).map((name) => resolve(name));

function pagesOf(folder) {
  return readdirSync(folder, { recursive: true })
    .filter((name) => name.endsWith(".html") && !name.split(sep).some((part) => ["files", "_downloads", "_static"].includes(part)))
    .sort();
}

function served(folder) {
  const server = createServer((request, response) => {
    const path = resolve(folder, "." + decodeURIComponent(new URL(request.url, "http://127.0.0.1").pathname));
    const inside = path.startsWith(folder + sep) && existsSync(path) && extname(path);
    const wanted = request.url !== "/favicon.ico"; // a browser asks for it by itself
    response.writeHead(inside ? 200 : wanted ? 404 : 204, { "Content-Type": KINDS[extname(path)] ?? "application/octet-stream" });
    if (inside) createReadStream(path).pipe(response);
    else response.end();
  });
  return new Promise((accept) => server.listen(0, "127.0.0.1", () => accept(server)));
}

// One connection of the DevTools protocol, over Chromium's pipe.
class Browser {
  constructor(profile) {
    const options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-sync", "--disable-component-update",
      "--disable-background-networking", "--hide-scrollbars", "--remote-debugging-pipe", `--user-data-dir=${profile}`];
    this.process = spawn(process.env.CHROMIUM ?? "chromium", options, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    this.waiting = new Map();
    this.heard = () => {};
    this.count = 0;
    let rest = "";
    this.process.stdio[4].setEncoding("utf8").on("data", (text) => {
      const messages = (rest + text).split("\0");
      rest = messages.pop();
      for (const message of messages.map(JSON.parse)) {
        if (message.id === undefined) this.heard(message.method, message.params);
        else this.answer(message);
      }
    });
  }

  answer({ id, result, error }) {
    const [accept, reject] = this.waiting.get(id);
    this.waiting.delete(id);
    if (error) reject(new Error(error.message));
    else accept(result);
  }

  ask(method, params = {}) {
    const id = ++this.count;
    this.process.stdio[3].write(JSON.stringify({ id, method, params, sessionId: this.session }) + "\0");
    return new Promise((accept, reject) => this.waiting.set(id, [accept, reject]));
  }

  async attach() {
    const { targetId } = await this.ask("Target.createTarget", { url: "about:blank" });
    this.session = (await this.ask("Target.attachToTarget", { targetId, flatten: true })).sessionId;
    for (const domain of ["Page", "Network", "Runtime", "Log"]) await this.ask(`${domain}.enable`);
  }

  async value(expression) {
    const { result, exceptionDetails } = await this.ask("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.text);
    return result.value;
  }
}

// Opens an address, and returns the faults that the browser heard until the page stood.
async function open(browser, address, width) {
  const faults = [];
  await browser.ask("Emulation.setDeviceMetricsOverride", { width, height: 900, deviceScaleFactor: 1, mobile: width < 600 });
  const loaded = new Promise((accept) => {
    browser.heard = (method, params) => {
      if (method === "Page.loadEventFired") accept();
      if (method === "Runtime.exceptionThrown") faults.push(`exception: ${params.exceptionDetails.text}`);
      if (method === "Runtime.consoleAPICalled" && params.type === "error") faults.push(`console: ${params.args[0]?.value}`);
      if (method === "Log.entryAdded" && params.entry.level === "error") faults.push(`console: ${params.entry.text} ${params.entry.url ?? ""}`);
      if (method === "Network.requestWillBeSent" && !params.request.url.startsWith(`${origin}/`) && !/^(data|blob|about):/.test(params.request.url)) {
        faults.push(`request leaves: ${params.request.url}`);
      }
    };
  });
  await browser.ask("Page.navigate", { url: address });
  await loaded;
  return faults;
}

const looks = (width) => `(async () => {
  for (const image of document.images) { image.loading = "eager"; await image.decode().catch(() => {}); }
  const lost = [...document.images].filter((image) => !image.naturalWidth).map((image) => image.src);
  return { lost, wide: document.documentElement.scrollWidth - ${width} };
})()`;
const FOUND = `new Promise((accept) => {
  const look = (left) => {
    const found = document.querySelector(".search-summary")?.textContent.match(/\\d+/);
    if (found || !left) accept(Number(found ?? 0)); else setTimeout(look, 100, left - 1);
  };
  look(100);
})`;

const server = await served(site);
const origin = `http://127.0.0.1:${server.address().port}`;
const profile = mkdtempSync(join(tmpdir(), "imuwb-browser-"));
const browser = new Browser(profile);
const faults = [];
try {
  await browser.attach();
  const pages = pagesOf(site);
  for (const page of pages) {
    for (const [name, width] of Object.entries(WIDTHS)) {
      const own = await open(browser, `${origin}/${page.replaceAll(sep, "/")}`, width);
      const { lost, wide } = await browser.value(looks(width));
      own.push(...lost.map((image) => `picture does not show: ${image}`));
      if (wide > 0) own.push(`${wide} pixels wider than the screen`);
      faults.push(...own.map((fault) => `${page} (${name}): ${fault}`));
      if (pictures) {
        mkdirSync(pictures, { recursive: true });
        const { data } = await browser.ask("Page.captureScreenshot", { captureBeyondViewport: true });
        writeFileSync(join(pictures, `${page.replaceAll(sep, "-").replace(".html", "")}-${name}.png`), Buffer.from(data, "base64"));
      }
    }
  }
  for (const words of SEARCHES) {
    const own = await open(browser, `${origin}/search.html?q=${words}`, WIDTHS.desk);
    const count = await browser.value(FOUND);
    console.log(`search for ${words}: ${count} pages`);
    if (!count) own.push("finds nothing");
    faults.push(...own.map((fault) => `search for ${words}: ${fault}`));
  }
  console.log([...faults, `${pages.length} pages opened at ${Object.values(WIDTHS).join(" and ")} pixels, ${faults.length} faults`].join("\n"));
} finally {
  browser.process.kill();
  await new Promise((accept) => browser.process.once("exit", accept));
  server.closeAllConnections();
  server.close();
  rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
}
process.exitCode = faults.length ? 1 : 0;
