// The command that finds the design of the page; the page itself saves nothing.
const FILES = {
  keys: { c: openCommand },
  acts: { copy: openCommand, "copy-yes": copyCommand, "copy-no": () => byId("copy-dialog").close() },
  open(design) { byId("beside").textContent = design.file; },
  enable() { byId("copy").disabled = !S.shown; },
  typed() {},
};
const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\"'\"'")}'`);
function command() {
  const sets = Object.entries(wishes(S.changes)).flatMap(([path, text]) => ["--set", `${path}=${text}`]);
  return [...S.design.command, ...sets].map(quoted).join(" ");
}
function openCommand() {
  if (byId("copy").disabled) return;
  byId("command").value = command();
  byId("copy-note").textContent = "";
  byId("copy-dialog").showModal();
  byId("command").select();
}
async function copyCommand() {
  byId("command").select();
  let copied = true;
  try { await navigator.clipboard.writeText(byId("command").value); } catch { copied = document.execCommand("copy"); }
  byId("copy-note").textContent = copied ? "Copied." : "This browser does not copy: press Ctrl-C.";
}
