/** A new machine by questions: those of `abbe init`, as a form. The library asks them and writes the file. */

import { button, make } from "../ui/dom";

/** A question, as `abbe::dialogue::MachineQuestion` has it. */
interface MachineQuestion {
  key: string;
  asked: string;
  default: string;
  wanted: string;
  choices: { answer: string; title: string; picture: string }[];
  is_understood: boolean;
}

/** Questions, and the file that the answers make. */
export interface MachineDialogue {
  questions: MachineQuestion[];
  file: string | null;
}

export type Answers = Record<string, string>;

/** Shows the form; `take` gets the file. */
export function showQuestions(
  ask: (answers: Answers) => Promise<MachineDialogue>,
  take: (file: string) => void,
  failed: (failure: unknown) => void,
): void {
  const answers: Answers = {};
  const form = make("form", { method: "dialog" });
  const fields = make("div", { class: "fields" });
  let file: string | null = null;
  const done = button("Take this machine", () => (dialog.close(), file !== null && take(file)), {
    class: "primary",
    id: "take-machine",
    title: "Replaces the text in the editor; Undo brings it back",
  });
  const close = button("Cancel", () => dialog.close());
  const dialog = make("dialog", { id: "questions", "aria-label": "A machine file by questions" }, form);
  form.append(make("h2", {}, "A machine file by questions"), fields, make("p", { class: "ends" }, done, close));
  let asked = 0;
  const update = async () => {
    const turn = (asked += 1);
    const found = await ask(answers);
    if (turn !== asked) return;
    file = found.file;
    done.disabled = file === null;
    const kept = new Map([...fields.querySelectorAll<HTMLElement>("[data-key]")].map((of) => [of.dataset["key"], of]));
    const all = found.questions.map((question) => {
      const field = kept.get(question.key) ?? fieldOf(question, answers, () => void update().catch(failed));
      tell(field, question, answers);
      return field;
    });
    // What stays is not moved: it may hold the cursor.
    for (const field of kept.values()) if (!all.includes(field)) field.remove();
    all.forEach((field, i) => fields.children[i] === field || fields.insertBefore(field, fields.children[i] ?? null));
  };
  dialog.addEventListener("close", () => dialog.remove());
  form.addEventListener("submit", (event) => event.preventDefault());
  document.body.append(dialog);
  update().then(() => dialog.showModal(), failed);
}

/** The field of a question: choices with pictures, a list of words, or a line of text. */
function fieldOf(question: MachineQuestion, answers: Answers, changed: () => void): HTMLElement {
  const { key, choices } = question;
  const take = (answer: string) => {
    answers[key] = answer;
    changed();
  };
  if (!choices.some(({ title }) => title)) {
    const options = choices.map(({ answer }) => make("option", {}, answer));
    const input = choices.length ? make("select", {}, ...options) : make("input", { type: "text" });
    input.addEventListener("input", () => take(input.value));
    return make(
      "label",
      { "data-key": key },
      make("span", {}, ...coded(question.asked)),
      input,
      make("em", { role: "status" }),
    );
  }
  const choice = ({ answer, title, picture }: MachineQuestion["choices"][number]) => {
    const input = make("input", { type: "radio", name: key, value: answer });
    input.checked = answer === question.default;
    input.addEventListener("change", () => take(answer));
    return make("label", {}, input, make("span", {}, ...coded(title)), ...(picture ? [make("pre", {}, picture)] : []));
  };
  const legend = make("legend", {}, ...coded(question.asked));
  return make("fieldset", { "data-key": key }, legend, ...choices.map(choice), make("em", { role: "status" }));
}

/** A text with what stands in backticks as code, which does not wrap. */
function coded(text: string): (Node | string)[] {
  return text.split("`").map((part, i) => (i % 2 ? make("code", {}, part) : part));
}

/** Shows the proposal where nothing is answered, and says what is wanted where an answer is not understood. */
function tell(field: HTMLElement, question: MachineQuestion, answers: Answers): void {
  const { key, wanted, is_understood } = question;
  const input = field.querySelector<HTMLInputElement | HTMLSelectElement>("input[type=text], select");
  if (input && !(key in answers)) input.value = question.default;
  if (input instanceof HTMLInputElement) input.placeholder = question.default;
  input?.setAttribute("aria-invalid", String(!is_understood));
  const words = field.querySelector("em");
  if (words) words.replaceChildren(...(is_understood ? [] : coded(`Wanted: ${wanted}.`)));
}
