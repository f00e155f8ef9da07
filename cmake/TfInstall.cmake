# Where the program and its two libraries are: beside each other in the build folder, bin/ and lib/ when installed. They find one another by
# paths relative to themselves, so that both trees can be moved.

foreach(library tf tf_codegen)
  if(TARGET ${library})
    set_target_properties(${library} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR} BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN")
    install(TARGETS ${library} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endif()
endforeach()
if(TARGET tf_codegen)
  set_target_properties(tf_codegen PROPERTIES OUTPUT_NAME tfcodegen)
endif()
set_target_properties(tfc PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR} BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

install(TARGETS tfc RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES runtime/tf.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/runtime)
install(FILES runtime/abi/tf_model.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/runtime/abi)
install(DIRECTORY stdlib/ DESTINATION ${CMAKE_INSTALL_DATADIR}/tfc/stdlib)
