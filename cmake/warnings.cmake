# Compile options of all our targets: IEEE arithmetic without contraction, because map and gate decisions depend on the
# last bit, and warnings. With precompiled headers g++ 12 takes system headers for ours and warns of them, so builds for
# users have no warnings; builds for developers have no precompiled headers.
add_library(surefoot_compile_options INTERFACE)
target_compile_options(surefoot_compile_options INTERFACE -ffp-contract=off)
if(SUREFOOT_PRECOMPILED_HEADERS)
  target_compile_options(surefoot_compile_options INTERFACE -w)
else()
  target_compile_options(surefoot_compile_options INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow
    -Wdouble-promotion -Wcast-align -Wnon-virtual-dtor
    $<$<BOOL:${SUREFOOT_WERROR}>:-Werror>)
endif()
