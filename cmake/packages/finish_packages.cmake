# Run by cpack when the files of the packages are in folders and before they are packed: what Debian's rules want beside what
# `cmake --install` installs, and which package a file is in where a component has more than a package.
file(GLOB manifests "${CPACK_C3DE_BUILD}/install_manifest*.txt")
file(GLOB kept "${CPACK_C3DE_BUILD}/CMakeFiles/kept_manifests/*.txt")
file(REMOVE ${manifests})
if(kept)
  file(COPY ${kept} DESTINATION "${CPACK_C3DE_BUILD}")
endif()
set(root "${CPACK_TEMPORARY_DIRECTORY}")
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  # MPI has to be that of the machine.
  file(REMOVE "${root}/bin/c3de-study-mpi" "${root}/share/man/man1/c3de-study-mpi.1.gz")
  return()
endif()

# write_documents(GROUP PACKAGE): copyright and changelog.
function(write_documents group package)
  set(folder "${root}/${group}/usr/share/doc/${package}")
  file(MAKE_DIRECTORY "${folder}")
  configure_file("${CPACK_C3DE_FILES}/copyright" "${folder}/copyright" COPYONLY)
  file(WRITE "${folder}/changelog" "c3de (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n"
    "  * Release ${CPACK_PACKAGE_VERSION}; docs/CHANGELOG.md of the package c3de has the changes.\n\n"
    " -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${CPACK_C3DE_RELEASE_TIME}\n")
  execute_process(COMMAND "${CPACK_C3DE_GZIP}" -9nf "${folder}/changelog" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(program "${root}/program/usr")
# The licence is one of the system, and the text that names others is the file copyright.
file(REMOVE "${program}/share/doc/c3de/LICENSE" "${program}/share/doc/c3de/licences/MPL-2.0" "${program}/share/doc/c3de/licences/CC0-1.0")
file(MAKE_DIRECTORY "${program}/share/doc/c3de/docs")
file(RENAME "${program}/share/doc/c3de/CHANGELOG.md" "${program}/share/doc/c3de/docs/CHANGELOG.md")
write_documents(program c3de)

file(REMOVE_RECURSE "${root}/development/usr/share/doc/c3de")
write_documents(development c3de-dev)
write_documents(python python3-c3de)

# Studies under MPI.
file(REMOVE "${program}/bin/c3de-study-mpi")
if(EXISTS "${root}/mpi")
  file(MAKE_DIRECTORY "${root}/mpi/usr/share/man/man1")
  file(RENAME "${program}/share/man/man1/c3de-study-mpi.1.gz" "${root}/mpi/usr/share/man/man1/c3de-study-mpi.1.gz")
  write_documents(mpi c3de-mpi)
else()
  file(REMOVE "${program}/share/man/man1/c3de-study-mpi.1.gz")
endif()

# The linker of the system finds libraries of packages.
file(GLOB binaries "${root}/*/usr/bin/*" "${root}/*/usr/lib/*.so.*" "${root}/*/usr/lib/c3de/*/*.so")
foreach(binary IN LISTS binaries)
  if(NOT IS_SYMLINK "${binary}")
    file(RPATH_REMOVE FILE "${binary}")
  endif()
endforeach()
