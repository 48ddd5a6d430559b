// Requests to the studio. The token comes in the address's fragment and leaves the address bar.
const KEY = "studio token";
if (location.hash.length > 1) {
  sessionStorage.setItem(KEY, location.hash.slice(1));
  history.replaceState(null, "", location.pathname);
}
const TAB = Array.from(crypto.getRandomValues(new Uint32Array(4)), (k) => k.toString(36)).join("");
const RETRY = 2000;

class Unfit extends Error {}

function bar(text) {
  byId("bar").hidden = !text;
  if (byId("bar").textContent !== text) byId("bar").textContent = text;
}
const pause = (time) => new Promise((resolve) => setTimeout(resolve, time));

// The answer to a wish; waits and asks again as long as the studio does not answer.
async function ask(route, wish) {
  for (;;) {
    let answer, data;
    try {
      answer = await fetch(`/api/${route}`, {
        method: "POST",
        headers: { "Content-Type": "application/json", "X-Studio-Token": sessionStorage.getItem(KEY) || "" },
        body: JSON.stringify({ tab: TAB, ...wish }),
      });
      data = await answer.json();
    } catch {
      bar("The studio does not answer. Nothing is lost: this page keeps what you asked for and tries again.");
      await pause(RETRY);
      continue;
    }
    if (answer.ok) { bar(""); return data; }
    if (answer.status === 401) {
      bar("This page belongs to an earlier start of the studio, or its key is missing. Open the address that the studio printed. What you asked for is still shown here.");
    } else if (answer.status !== 422) {
      bar(`The studio reports a fault: ${data.error}`);
    }
    throw new Unfit(data.error);
  }
}
