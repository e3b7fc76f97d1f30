# Makes the pages of tools/manual/ a source file, so that the program carries its manual.
file(GLOB manual_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/manual/*.md)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${manual_files})
set(manual_rows "")
foreach(file ${manual_files})
  get_filename_component(subject ${file} NAME_WE)
  file(READ ${file} text)
  string(APPEND manual_rows "    {\"${subject}\", R\"manual(${text})manual\"},\n")
endforeach()
set(manual_source ${PROJECT_BINARY_DIR}/manual_pages.cpp)
file(GENERATE OUTPUT ${manual_source} CONTENT
"#include \"tools/manual_pages.h\"

namespace condyle {

std::span<const ManualPage> manual_pages() {
  static constexpr ManualPage pages[] = {
${manual_rows}  };
  return pages;
}

}  // namespace condyle
")
