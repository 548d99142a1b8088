# surefoot_precompile(TARGET): gives a target the precompiled common headers, if SUREFOOT_PRECOMPILED_HEADERS is on.
# A source with compile options of its own needs SKIP_PRECOMPILE_HEADERS. No source may rely on these headers: it includes
# what it uses, and builds for developers have no precompiled headers.
set(surefoot_common_headers
  <fmt/format.h> <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <functional> <limits> <memory>
  <optional> <span> <string> <string_view> <vector>)

if(SUREFOOT_PRECOMPILED_HEADERS)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "// Compiles the common headers.\n")
  add_library(surefoot_precompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(surefoot_precompiled PRIVATE surefoot_compile_options Eigen3::Eigen fmt::fmt)
  target_precompile_headers(surefoot_precompiled PRIVATE ${surefoot_common_headers})
endif()

function(surefoot_precompile target)
  if(SUREFOOT_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM surefoot_precompiled)
  endif()
endfunction()
