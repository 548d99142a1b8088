if(SUREFOOT_SANITIZE)
  string(REPLACE ";" "," _sanitizers "${SUREFOOT_SANITIZE}")
  add_compile_options(-fsanitize=${_sanitizers} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1)
  add_link_options(-fsanitize=${_sanitizers})
  if("undefined" IN_LIST SUREFOOT_SANITIZE)
    # Not part of it, but undefined: a number beyond all integers as one.
    add_compile_options(-fsanitize=float-cast-overflow)
    # core.CheckedIndex asks whether it really stops.
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
