# surefoot_embed(OUTPUT PATTERN HEADER NAMESPACE TYPE FUNCTION): embeds files into the program,
# so that it needs no installed data. See embed_resources.cmake for the arguments.
function(surefoot_embed output pattern header namespace type function)
  file(GLOB files CONFIGURE_DEPENDS ${pattern})
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed_resources.cmake)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D "OUTPUT=${output}" -D "PATTERN=${pattern}" -D "HEADER=${header}"
            -D "NAMESPACE=${namespace}" -D "TYPE=${type}" -D "FUNCTION=${function}" -P ${script}
    DEPENDS ${files} ${script}
    COMMENT "Embedding ${pattern}" VERBATIM)
endfunction()
