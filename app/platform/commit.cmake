# Writes commit.h, if the commit has changed: cmake -DSOURCE=DIR -DHEADER=FILE -DCOMMIT=TEXT -P commit.cmake
# COMMIT, if not empty, replaces the commit that git names: for sources without their repository.
cmake_minimum_required(VERSION 3.20)
if(NOT COMMIT)
  execute_process(COMMAND git describe --always --dirty --abbrev=10 --exclude=* WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#pragma once\n#define FOCI_COMMIT \"@COMMIT@\"\n" @ONLY)
