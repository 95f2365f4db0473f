// Prints docs/reference/javascript.md: what core/src/index.ts exports, with its comments. scripts/docs calls it, and
// shared/test/reference_page.test.ts compares the page with it.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import ts from 'typescript';

const HEAD = `# JavaScript reference

This page lists everything that the npm package \`alidade\` exports. \`scripts/docs\` generates it from the declarations
and comments in \`web/core/src/index.ts\`; do not edit it. The package's [README](../../web/core/README.md) has an
example.
`;

const code = (text) => `\`\`\`ts\n${text}\n\`\`\``;

// The text of a JSDoc comment before a declaration, as one paragraph; '': none.
function commentOf(node) {
  return ts.getJSDocCommentsAndTags(node).filter(ts.isJSDoc)
    .map((comment) => ts.getTextOfJSDocComment(comment.comment)?.replace(/\s+/g, ' ') ?? '').join(' ');
}

// Lines of at most 120 columns.
function wrapped(text) {
  const lines = [''];
  for (const word of text.split(' ')) {
    const last = lines.at(-1);
    if (last && last.length + 1 + word.length > 120) lines.push(word);
    else lines[lines.length - 1] = last ? `${last} ${word}` : word;
  }
  return lines.join('\n');
}

const has = (node, kind) => node.modifiers?.some((modifier) => modifier.kind === kind) ?? false;
const isHidden = (member) => (member.name && ts.isPrivateIdentifier(member.name)) || has(member, ts.SyntaxKind.PrivateKeyword);

// A declaration as in the source, without the body of a function and the initial value of a field.
function headOf(node, file) {
  const text = file.text.slice(node.getStart(file), (node.body ?? node.initializer)?.pos ?? node.end);
  return text.replace(/^export /, '').replace(/\s*(=|\{)?\s*;?\s*$/, '');
}

function classText(node, file) {
  const parts = [`### ${node.name.text}`];
  const comment = commentOf(node);
  if (comment) parts.push(wrapped(comment));
  for (const member of node.members) {
    if (isHidden(member) || has(member, ts.SyntaxKind.OverrideKeyword)) continue;
    parts.push(code(headOf(member, file)));
    const words = commentOf(member);
    if (words) parts.push(wrapped(words));
  }
  return parts;
}

// Line comments directly above a declaration are part of its text; JSDoc comments become prose.
function declarationText(node, file, name) {
  const comment = commentOf(node);
  const after = ts.getTrailingCommentRanges(file.text, node.end)?.at(-1);
  const text = file.text.slice(node.getStart(file), after?.end ?? node.end).replace(/^export /, '');
  return [`### ${name}`, ...(comment ? [wrapped(comment)] : []), code(text)];
}

// The names and words of the failures, from their generated source.
function failuresText(source) {
  const [, names] = /FAILURES = (\[[^\]]*\])/.exec(source);
  const [, words] = /REASONS[^=]*= (\{[^}]*\})/.exec(source);
  const reasons = JSON.parse(words);
  return ['### Failure', 'Why a frame has no pose: one of `FAILURES`. `REASONS` has the words.',
    `| failure | words |\n|---|---|\n${JSON.parse(names).map((name) => `| \`${name}\` | ${reasons[name]} |`).join('\n')}`];
}

export function page(source, failures) {
  const file = ts.createSourceFile('index.ts', source, ts.ScriptTarget.Latest, true);
  const classes = [];
  const types = [];
  for (const node of file.statements) {
    if (!has(node, ts.SyntaxKind.ExportKeyword)) continue;
    if (ts.isClassDeclaration(node)) classes.push(classText(node, file));
    else if (ts.isVariableStatement(node)) types.push(declarationText(node, file, node.declarationList.declarations[0].name.getText(file)));
    else if (!ts.isExportDeclaration(node)) types.push(declarationText(node, file, node.name.text));
  }
  classes.sort(([a], [b]) => (a === '### Slam' ? -1 : b === '### Slam' ? 1 : 0));
  return [HEAD.trimEnd(), '## Classes', ...classes.flat(), '## Types', ...types.flat(), ...failuresText(failures)].join('\n\n') + '\n';
}

const read = (path) => readFileSync(fileURLToPath(new URL(path, import.meta.url)), 'utf8');

if (process.argv[1] === fileURLToPath(import.meta.url))
  process.stdout.write(page(read('../core/src/index.ts'), read('../core/src/generated/failures.ts')));
