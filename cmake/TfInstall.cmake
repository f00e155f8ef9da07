# Where the program and its two libraries are: beside each other in the build folder, bin/ and lib/ when installed. They find one another by
# paths relative to themselves, so that both trees can be moved.

set_target_properties(tf_codegen PROPERTIES OUTPUT_NAME tfcodegen)
set_target_properties(tf tf_codegen PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR} INSTALL_RPATH "$ORIGIN")
set_target_properties(tfc PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR} INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
set_target_properties(tf tf_codegen tfc PROPERTIES BUILD_WITH_INSTALL_RPATH ON)

install(TARGETS tfc RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS tf tf_codegen LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES runtime/tf.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/runtime)
install(FILES runtime/abi/tf_model.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/runtime/abi)
install(DIRECTORY stdlib/ DESTINATION ${CMAKE_INSTALL_DATADIR}/tfc/stdlib)
