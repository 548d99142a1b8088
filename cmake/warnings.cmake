# Compile options of all our targets: warnings, and IEEE arithmetic without contraction,
# because map and gate decisions depend on the last bit.
add_library(surefoot_compile_options INTERFACE)
target_compile_options(surefoot_compile_options INTERFACE
  -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow
  -Wdouble-promotion -Wcast-align -Wnon-virtual-dtor
  $<$<BOOL:${SUREFOOT_WERROR}>:-Werror>)
