# Writes OUTPUT: a C++ source with every machine file as a string literal.
file(GLOB files ${SOURCE_DIR}/machines/*.yaml)
set(entries "")
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME)
  get_filename_component(folder ${file} DIRECTORY)
  get_filename_component(folder ${folder} NAME)
  file(READ ${file} text)
  string(APPEND entries "    {\"${folder}/${name}\", R\"yaml(${text})yaml\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// Generated from machines/.
#include \"apps/surefoot/resources.hpp\"

namespace surefoot::app {

const std::vector<Resource>& resources() {
    static const std::vector<Resource> all = {
${entries}    };
    return all;
}

}  // namespace surefoot::app
")
