/** The editor of the machine file. Everything that changes the file is a change of its text. */

import { closeBrackets } from "@codemirror/autocomplete";
import {
  defaultKeymap,
  history,
  historyKeymap,
  isolateHistory,
  redo,
  redoDepth,
  undo,
  undoDepth,
} from "@codemirror/commands";
import { yaml } from "@codemirror/lang-yaml";
import { bracketMatching, HighlightStyle, indentOnInput, syntaxHighlighting } from "@codemirror/language";
import { lintGutter, lintKeymap } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { Compartment, EditorState } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Change } from "./chain";
import { completion, type Language } from "./complete";
import type { FileNumber } from "./numbers";
import { written } from "./numbers";

/** What hears of the editor. */
export interface Listener {
  /** The text is another one; `draft` while a slider is held. */
  changed(draft: boolean): void;
  /** The cursor is elsewhere. */
  cursor(): void;
  save(): void;
  /** What is known of machine files, for completion. */
  language(): Language | null;
  /** What a name in the text is. */
  explain(name: string): HTMLElement | null;
}

const COLOURS = HighlightStyle.define([
  { tag: [tags.definition(tags.propertyName), tags.propertyName], color: "var(--accent)" },
  { tag: [tags.lineComment, tags.comment], color: "var(--faint)", fontStyle: "italic" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--text-string)" },
  { tag: [tags.separator, tags.punctuation, tags.squareBracket, tags.brace], color: "var(--faint)" },
]);

const LOOK = EditorView.theme({
  "&": { height: "100%", fontSize: "12.5px", color: "var(--ink)", backgroundColor: "var(--card)" },
  ".cm-scroller": { fontFamily: "ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace", lineHeight: "1.5" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-gutters": { backgroundColor: "var(--card)", color: "var(--faint)", border: "none" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "var(--line-active)" },
  "&.cm-focused .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "var(--selection) !important" },
  "&.cm-focused .cm-cursor": { borderLeftColor: "var(--ink)" },
  ".cm-tooltip": {
    backgroundColor: "var(--ground)",
    color: "var(--ink)",
    border: "1px solid var(--line)",
    maxWidth: "34rem",
  },
  ".cm-tooltip-autocomplete > ul > li": { fontFamily: "system-ui, sans-serif", padding: "2px 6px" },
  ".cm-tooltip-autocomplete > ul > li[aria-selected]": { background: "var(--selection)", color: "var(--ink)" },
  ".cm-completionLabel": { fontWeight: "600" },
  ".cm-completionDetail": { color: "var(--faint)", fontStyle: "normal" },
  ".cm-diagnostic": { whiteSpace: "pre-wrap", fontFamily: "system-ui, sans-serif" },
  ".cm-panels": { backgroundColor: "var(--card)", color: "var(--ink)" },
});

/** Time between two drawings of the digits that a held slider writes, ms: drawing them costs more than a figure. */
const REST = 250;

export class Editor {
  readonly view: EditorView;
  /** Digits of a held slider in the view. */
  private dragging: string | null = null;
  /** Digits of a held slider that the view does not show yet. */
  private pending: Change | null = null;
  private rest = 0;
  private readonly wrapping = new Compartment();
  private wraps = false;
  /** True while the view takes what the listener knows already. */
  private isWriting = false;

  constructor(
    parent: HTMLElement,
    nonce: string,
    readonly isReadOnly: boolean,
    private readonly listener: Listener,
  ) {
    this.view = new EditorView({ parent, state: this.state("", nonce) });
  }

  get text(): string {
    const { doc } = this.view.state;
    if (!this.pending) return doc.toString();
    const { from, to, insert } = this.pending;
    return doc.sliceString(0, from) + insert + doc.sliceString(to ?? from);
  }

  /** Takes another file; nothing of the one before can be undone into it. */
  open(text: string, nonce: string): void {
    this.forget();
    this.view.setState(this.state(text, nonce));
  }

  /** Long lines go on below, or leave the pane. */
  wrap(does: boolean): void {
    this.wraps = does;
    this.view.dispatch({ effects: this.wrapping.reconfigure(does ? EditorView.lineWrapping : []) });
  }

  /** Writes texts in place of ranges, as one step of undo. */
  change(change: Change | Change[]): void {
    this.write();
    this.view.dispatch({ changes: change, annotations: isolateHistory.of("full"), userEvent: "input.workbench" });
  }

  /** Replaces the digits of a number while a slider is held: all of it is one step of undo. The text has them at once. */
  drag(number: FileNumber, value: number, decimals: number): void {
    const isFirst = this.dragging === null && !this.pending;
    this.pending = { from: number.from, to: number.from + this.held(number), insert: written(value, decimals) };
    if (isFirst) this.write();
    else if (!this.rest) this.rest = window.setTimeout(() => this.write(), REST);
    this.listener.changed(true);
  }

  /** Brings into the view what a held slider wrote last. */
  write(): void {
    const changes = this.pending;
    this.forget();
    if (!changes) return;
    // A composition joins the step before it, however long the slider rests.
    const first = { annotations: isolateHistory.of("before"), userEvent: "input.workbench" };
    const isFirst = this.dragging === null;
    this.dragging = changes.insert;
    this.isWriting = true;
    this.view.dispatch({ changes, ...(isFirst ? first : { userEvent: "input.type.compose" }) });
    this.isWriting = false;
  }

  private forget(): void {
    window.clearTimeout(this.rest);
    this.rest = 0;
    this.pending = null;
  }

  /** The slider is let go. */
  drop(): void {
    this.write();
    if (this.dragging === null) return;
    this.dragging = null;
    this.view.dispatch({ annotations: isolateHistory.of("after") });
    this.listener.changed(false);
  }

  /** Puts the cursor at a place and shows it. */
  reveal(position: number): void {
    this.view.dispatch({
      selection: { anchor: position },
      effects: EditorView.scrollIntoView(position, { y: "center" }),
    });
    this.view.focus();
  }

  undo(): void {
    this.write();
    undo(this.view);
  }

  redo(): void {
    this.write();
    redo(this.view);
  }

  get canUndo(): boolean {
    return undoDepth(this.view.state) > 0;
  }

  get canRedo(): boolean {
    return redoDepth(this.view.state) > 0;
  }

  /** Length of the digits in the text: those of the file, or those that the held slider wrote last. */
  private held(number: FileNumber): number {
    return this.dragging?.length ?? number.to - number.from;
  }

  private state(doc: string, nonce: string): EditorState {
    const save = { key: "Mod-s", preventDefault: true, run: () => (this.listener.save(), true) };
    return EditorState.create({
      doc,
      extensions: [
        EditorView.cspNonce.of(nonce),
        EditorState.readOnly.of(this.isReadOnly),
        // Also what the page's own controls would write.
        EditorState.changeFilter.of(() => !this.isReadOnly),
        EditorView.contentAttributes.of({ "aria-label": "Machine file", tabindex: "0" }),
        this.wrapping.of(this.wraps ? EditorView.lineWrapping : []),
        lineNumbers(),
        lintGutter(),
        history(),
        drawSelection(),
        highlightActiveLine(),
        indentOnInput(),
        bracketMatching(),
        closeBrackets(),
        completion(
          () => this.listener.language(),
          (name) => this.listener.explain(name),
        ),
        highlightSelectionMatches(),
        yaml(),
        syntaxHighlighting(COLOURS),
        LOOK,
        keymap.of([save, ...defaultKeymap, ...historyKeymap, ...searchKeymap, ...lintKeymap]),
        EditorView.updateListener.of((update) => {
          if (update.docChanged && !this.isWriting) this.listener.changed(this.dragging !== null);
          if (update.docChanged || update.selectionSet) this.listener.cursor();
        }),
      ],
    });
  }
}
