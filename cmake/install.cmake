include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(_modules GLOBAL PROPERTY SUREFOOT_MODULES)
install(TARGETS ${_modules} EXPORT surefoot_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# Test helpers and headers that need OpenCV are not installed.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/surefoot DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*_testing.hpp" EXCLUDE PATTERN "charuco.hpp" EXCLUDE)
install(EXPORT surefoot_targets NAMESPACE surefoot:: FILE surefoot-targets.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/surefoot)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/surefoot-config.cmake.in
  ${PROJECT_BINARY_DIR}/surefoot-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/surefoot)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/surefoot-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/surefoot-config.cmake
  ${PROJECT_BINARY_DIR}/surefoot-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/opencv_modules.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/surefoot)
