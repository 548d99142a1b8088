if(SUREFOOT_SANITIZE)
  string(REPLACE ";" "," _sanitizers "${SUREFOOT_SANITIZE}")
  add_compile_options(-fsanitize=${_sanitizers} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1)
  add_link_options(-fsanitize=${_sanitizers})
  if("undefined" IN_LIST SUREFOOT_SANITIZE)
    # Not part of "undefined": the conversion of a floating-point number beyond the integer's range.
    add_compile_options(-fsanitize=float-cast-overflow)
    # The test core.CheckedIndex checks that this sanitizer stops the program.
    add_compile_definitions(SUREFOOT_CHECKS_FLOAT_CASTS)
  endif()
endif()
if(SUREFOOT_COVERAGE)
  add_compile_options(--coverage -g1)
  add_link_options(--coverage)
endif()
if(SUREFOOT_FUZZ)
  # Coverage of the libraries guides the search; without it libFuzzer sees only its own targets.
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
