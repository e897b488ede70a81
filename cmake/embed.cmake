# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
# cmake -DOUTPUT=table.cpp -DFILES=a;b -P embed.cmake: the files' bytes as a C++ table (daemon/web/page_files.h).
set(text "#include \"daemon/web/page_files.h\"\n\nnamespace lightwell {\nnamespace {\n")
set(rows "")
set(index 0)
foreach(file ${FILES})
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" escaped "${hex}")
  # Lines of 32 bytes: no line of the table grows beyond what compilers and editors take.
  string(LENGTH "${escaped}" length)
  set(literal " \"\"")
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${escaped}" ${at} 128 line)
    string(APPEND literal "\n    \"${line}\"")
    math(EXPR at "${at} + 128")
  endwhile()
  get_filename_component(name "${file}" NAME)
  string(APPEND text "constexpr char kFile${index}[] =${literal};\n")
  string(APPEND rows "    {\"${name}\", {kFile${index}, sizeof kFile${index} - 1}},\n")
  math(EXPR index "${index} + 1")
endforeach()
string(APPEND text "constexpr PageFile kFiles[] = {\n${rows}};\n}  // namespace\n\n"
                   "std::span<const PageFile> page_files() { return kFiles; }\n}  // namespace lightwell\n")
file(WRITE "${OUTPUT}" "${text}")
