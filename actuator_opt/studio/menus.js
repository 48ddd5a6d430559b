// Words of the design as menus: joints, seals, materials, sizes. A choice is solved like any change.
const WIDE = 860;  // from here on the page has two columns, as in its style

class Menu {
  constructor(path, acts) {
    this.path = path;
    const id = `m${Menu.count++}`;
    this.select = node("select", { id });
    this.label = node("label", { htmlFor: id });
    this.told = node("p", { className: "hint", id: `${id}t` });
    this.box = node("div", { className: "menu" }, this.label, this.select, this.told);
    this.box.dataset.path = path;
    this.select.setAttribute("aria-describedby", this.told.id);
    // After a choice by mouse or Enter the keys belong to the page again; arrow keys and letters go on choosing.
    let key = "";
    this.select.addEventListener("pointerdown", () => { key = ""; });
    this.select.addEventListener("keydown", (event) => { key = event.key; });
    this.select.addEventListener("change", () => {
      if (key === "" || key === "Enter") this.select.blur();
      acts.choose(this, this.valueOf(this.select.selectedIndex));
    });
  }
  // What the studio offers now; `row` is the number if the menu lists sizes, `file` the file's word.
  offer(menu, row) {
    this.menu = menu;
    this.row = menu.options.some((one) => one.size !== null) ? row : null;
    if (this.row) this.file = exact(shown(row, row.value));
    else this.file ??= menu.word;
    this.label.textContent = menu.label;
    this.select.replaceChildren(...menu.options.map((one) => node("option", {
      value: one.word, textContent: one.reason ? `${one.label} – ${one.reason}` : one.label, disabled: Boolean(one.reason), title: one.reason || one.help,
    })));
  }
  valueOf(index) {
    const option = this.menu.options[index];
    return !option ? this.value : this.row ? exact(shown(this.row, option.size)) : option.word;
  }
  show(value) {
    this.value = value;
    const index = this.menu.options.findIndex((one, k) => this.valueOf(k) === value || one.word === value);
    this.select.querySelector(".own")?.remove();
    if (index < 0 && this.row) {
      this.select.append(node("option", { className: "own", textContent: `${withUnit(trimmed(value, 4), this.row.unit)}, no standard size` }));
    }
    this.select.selectedIndex = index < 0 && this.row ? this.menu.options.length : index;
    this.select.title = [this.select.selectedOptions[0]?.textContent, this.menu.options[index]?.help].filter(Boolean).join(": ");
    this.box.classList.toggle("changed", value !== this.file);
  }
  wish(value) { return this.row ? withUnit(String(value), this.row.typed) : value; }
  tell(text, fault) {
    this.told.textContent = text;
    this.told.className = fault ? "fault" : "hint";
    if (fault) this.select.setAttribute("aria-invalid", "true");
    else this.select.removeAttribute("aria-invalid");
  }
  refuse(text) { if (text) this.tell(text, true); }
}
Menu.count = 0;

const CHOICES = {
  async choose(menu, value) {
    const { path } = menu, wish = menu.wish(value);
    byId("main").setAttribute("aria-busy", "true");
    menu.tell("searching …");
    CHOICES.pending = menu;
    try {
      let data;
      do {
        if (data) await pause(CALM);  // a slider was moved meanwhile
        data = await ask("solve", { changes: { ...wishes(S.changes), [path]: wish }, describe: true });
      } while (data.dropped);
      CHOICES.pending = null;
      menu.tell("");
      const before = S.shown.feasible && S.shownFor === keyOf(S.changes) ? S.shown.objective : null;
      change(path, value);
      commit(path);
      LINE.latest++;
      CHOICES.compared = { menu, key: keyOf(S.changes), objective: before };
      truth(data, S.changes);
    } catch (fault) {
      CHOICES.pending = null;
      if (!(fault instanceof Unfit)) throw fault;
      menu.tell(fault.message.replace(`${path}: `, ""), true);
      menu.show(S.changes[path] ?? menu.file);
      if (!LINE.active) byId("main").setAttribute("aria-busy", "false");
    }
  },
  compared: null,
  pending: null,  // the menu whose choice is not part of the state yet
  // Menus of the present words; those without meaning are kept for undo, but hidden.
  offer(design) {
    const rows = new Map(design.numbers.map((row) => [row.path, row])), groups = new Map();
    for (const offered of design.menus ?? []) {
      let menu = S.menus.get(offered.path);
      if (!menu) S.menus.set(offered.path, menu = new Menu(offered.path, CHOICES));
      menu.offer(offered, rows.get(offered.path));
      if (!groups.has(offered.group)) groups.set(offered.group, []);
      groups.get(offered.group).push(menu);
    }
    const focused = document.activeElement;
    byId("menus").replaceChildren(...["Joint", "Sizes", "Materials", "Seals", "Build"].filter((group) => groups.has(group)).map((group) =>
      node("fieldset", {}, node("legend", { textContent: group }), ...groups.get(group).map((menu) => menu.box))));
    if (byId("menus").contains(focused)) focused.focus();
    if (byId("choices").hidden) byId("choices").open = innerWidth > WIDE;
    byId("choices").hidden = !groups.size;
    const known = new Set(rows.keys());
    for (const [path, slider] of S.sliders) slider.box.hidden = !known.has(path) || !slider.box.isConnected;
    const across = byId("across");
    for (const one of across.options) one.disabled = !known.has(one.value);
    if (across.selectedOptions[0]?.disabled) across.value = [...across.options].find((one) => !one.disabled).value;
  },
  show() {
    for (const [path, menu] of S.menus) if (menu !== CHOICES.pending) menu.show(S.changes[path] ?? menu.file);
  },
  // What the last choice changed; said once its optimum is painted.
  tell() {
    const { compared } = CHOICES;
    if (!compared || S.shownFor !== keyOf(S.changes)) return;
    for (const menu of S.menus.values()) if (menu !== compared.menu) menu.tell("");
    if (compared.key !== S.shownFor) { compared.menu.tell(""); return; }
    const { objective, feasible, searched } = S.shown;
    if (!feasible) { compared.menu.tell("nothing fits"); return; }
    const step = compared.objective === null || objective === null ? "" : `, ${difference(objective, compared.objective)}`;
    compared.menu.tell(`${objectiveText(objective)}${step}${searched ? "" : "; searching for a better one …"}`);
  },
};
PARTS.push({ described(design) { CHOICES.offer(design); CHOICES.show(); }, painted() { CHOICES.show(); CHOICES.tell(); } });
function difference(now, before) {
  const step = (now - before) * S.goal.factor;
  return Math.abs(step) < 1e-5 * Math.abs(S.goal.factor * before) ? "no change" : `${signed(step, 3)}${S.goal.unit ? ` ${S.goal.unit}` : ""}`;
}
