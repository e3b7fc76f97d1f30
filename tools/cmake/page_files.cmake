# Makes script and style of the page of a moving patient a source file, so that the program carries them.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/render/page/viewer.css ${PROJECT_SOURCE_DIR}/render/page/viewer.js)
file(READ ${PROJECT_SOURCE_DIR}/render/page/viewer.css viewer_style)
file(READ ${PROJECT_SOURCE_DIR}/render/page/viewer.js viewer_script)
set(page_source ${PROJECT_BINARY_DIR}/page_files.cpp)
file(GENERATE OUTPUT ${page_source} CONTENT
"#include \"render/page/page_files.h\"

namespace condyle {

const char* const viewer_style = R\"viewer(${viewer_style})viewer\";
const char* const viewer_script = R\"viewer(${viewer_script})viewer\";

}  // namespace condyle
")
target_sources(render_page PRIVATE ${page_source})
set_source_files_properties(${page_source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
