# Run by cpack when the files of a package for Windows are in their folder: the lists of files are for `uninstall` of installations.
file(GLOB manifests "${CPACK_BUILD_SOURCE_DIRS}/install_manifest*.txt")
if(manifests)
  file(REMOVE ${manifests})
endif()
