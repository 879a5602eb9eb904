# find_package(treeline) for other projects: the header templates, with none of the peers.
include(CMakePackageConfigHelpers)

foreach(part geometry accel shading)
  set_target_properties(treeline_${part} PROPERTIES EXPORT_NAME ${part})
  install(DIRECTORY ${part} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/treeline FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(TARGETS treeline_geometry treeline_accel treeline_shading EXPORT treeline_targets)
install(EXPORT treeline_targets NAMESPACE treeline:: FILE treelineTargets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/treeline)
configure_package_config_file(cmake/treelineConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/treelineConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/treeline)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/treelineConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/treelineConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/treelineConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/treeline)
