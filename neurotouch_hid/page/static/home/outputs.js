// Names the output of a binding as the list of outputs does.

const MODE = /^(toggle|sticky|oneshot|turbo) /;

export function nameOutput(groups, output) {
  const plain = output.replace(MODE, "");
  const group = groups.find(({ outputs }) => outputs.some((each) => each.do === plain));
  if (!group) return output;
  const { label } = group.outputs.find((each) => each.do === plain);
  const mode = output.slice(0, output.length - plain.length);
  const device = { Keyboard: "key ", Mouse: "mouse: " }[group.name]
    || (group.name === "Buttons" && label.length === 1 ? "button " : "");
  return `${mode}${device}${label}`;
}
