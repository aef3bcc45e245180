# Writes a .cpp with the bytes of the page's files:
# cmake -D FOLDER=… -D NAMES="a.html;b.js" -D OUTPUT=… -P embed.cmake
set(arrays "")
set(table "")
set(number 0)
foreach(name ${NAMES})
  file(READ ${FOLDER}/${name} bytes HEX)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND arrays "constexpr char kFile${number}[] = {\n    ${bytes}0};\n")
  string(APPEND table "    {\"${name}\", std::string_view(kFile${number}, sizeof(kFile${number}) - 1)},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"apps/studio/http/web_files.h\"

namespace scumble {
namespace {

${arrays}
constexpr EmbeddedFile kFiles[] = {
${table}};

}  // namespace

std::span<const EmbeddedFile> EmbeddedFiles() { return kFiles; }

}  // namespace scumble
")
