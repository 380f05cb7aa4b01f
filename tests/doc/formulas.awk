# Doxygen's input filter. Our docstrings indent formulas and tables by four blanks, which Markdown takes
# for running text unless an empty line precedes. Lines keep their numbers.
function flush() { if (held != "") print held; held = "" }
{
  comment = match($0, /^ *\/\/\/ /)
  indented = match($0, /^ *\/\/\/     +[^ ]/)
  if (comment && !indented) tag = match($0, /^ *\/\/\/ [@-]/)
  if (!comment) tag = 0
  block = indented && !tag
  if (block && !inside) { flush(); sub(/\/\/\/     /, "/// @verbatim "); held = $0; inside = 1; next }
  if (inside && !block) { held = held " @endverbatim"; inside = 0 }
  if (inside) sub(/\/\/\/     /, "///           ")
  flush()
  held = $0
  if (held == "") print
}
END { flush() }
