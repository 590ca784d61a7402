// The sub-commands of `foci`.
//
// Each function adds one sub-command to the command line. The sub-command runs while CLI11 parses
// the arguments. Bad input leaves as InputError, which `main` reports.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace foci {

void addCalibrateCommand(CLI::App& app);  ///< the screen, a tracker, a webcam or a camera
void addChartCommand(CLI::App& app);      ///< time and error of every method
void addDoctorCommand(CLI::App& app);     ///< what this machine offers
void addEventsCommand(CLI::App& app);     ///< eye movements of a recording
void addEyeCommand(CLI::App& app);        ///< the observer's eye itself
void addFiguresCommand(CLI::App& app);    ///< figures of a run for a paper
void addInfoCommand(CLI::App& app);       ///< facts about a scene
void addKeysCommand(CLI::App& app);       ///< the keys of a study file
void addManualCommand(CLI::App& app);     ///< man pages and shell completions
void addMethodsCommand(CLI::App& app);    ///< the depth-of-field methods
void addPrepareCommand(CLI::App& app);    ///< points or a mesh to a scene file
void addRenderCommand(CLI::App& app);     ///< one image
void addReproduceCommand(CLI::App& app);  ///< the tables and figures of the 2003 paper
void addTraceCommand(CLI::App& app);      ///< facts about a recording, and its conversion to BIDS
void addValidateCommand(CLI::App& app);   ///< foci against published measurements
void addWebcamCommand(CLI::App& app);     ///< what the webcam tracker sees

/// @param command_line  as the user typed it; the manifest of the run states it
void addLiveCommand(CLI::App& app, const std::string& command_line);
void addReplayCommand(CLI::App& app, const std::string& command_line);
void addCompareCommand(CLI::App& app);                                ///< runs side by side
void addJoinCommand(CLI::App& app, const std::string& command_line);  ///< parts of a replay

}  // namespace foci
