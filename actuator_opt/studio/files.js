// Save the optimum as a design file, and write its report.
const FILES = {
  keys: { s: openSave },
  acts: { save: openSave, report: writeReport, "save-yes": saveFile, "save-no": () => byId("save-dialog").close() },
  open(design) { byId("beside").textContent = design.file; },
  enable(fits) { byId("save").disabled = byId("report").disabled = !fits; },
  typed(event) { if (event.key === "Enter" && event.target === byId("file")) { event.preventDefault(); saveFile(); } },
};
let REPLACING = { name: "", sha256: "" };
function openSave() {
  if (byId("save").disabled) return;
  REPLACING = { name: "", sha256: "" };
  byId("save-note").textContent = "";
  byId("save-yes").textContent = "Save";
  byId("file").value ||= S.design.suggested;
  byId("save-dialog").showModal();
  byId("file").select();
}
async function saveFile() {
  let name = byId("file").value.trim();
  if (!name.endsWith(".yaml")) name += ".yaml";
  const replacing = REPLACING.name === name ? REPLACING.sha256 : "";
  byId("save-yes").disabled = true;
  try {
    const saved = await ask("save", { changes: wishes(S.changes), name, replacing });
    if (saved.written) {
      byId("save-dialog").close();
      note(`Saved ${saved.name} beside ${S.design.file}.`);
      byId("live").textContent = `Saved ${saved.name}`;
    } else {
      REPLACING = saved;
      byId("save-note").textContent = `Replace ${saved.name}? It exists${replacing ? ", and has changed just now" : ""}.`;
      byId("save-yes").textContent = "Replace";
    }
  } catch (fault) {
    byId("save-note").textContent = fault.message;
  } finally {
    byId("save-yes").disabled = false;
  }
}
async function writeReport() {
  byId("report").disabled = true;
  note("The report is being written …");
  try {
    const { files } = await ask("report", { changes: wishes(S.changes) });
    note(`Report: ${files.join(", ")}`);
  } catch (fault) {
    note(fault.message);
  }
  paintButtons();
}
byId("file").addEventListener("input", () => { byId("save-yes").textContent = "Save"; byId("save-note").textContent = ""; REPLACING = { name: "", sha256: "" }; });
