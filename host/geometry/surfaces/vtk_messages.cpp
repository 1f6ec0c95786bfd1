// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/vtk_messages.hpp"

#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <mutex>

namespace palpate {

namespace {

constexpr std::size_t max_text = 4000;

class Window : public vtkOutputWindow {
public:
    vtkTypeMacro(Window, vtkOutputWindow);
    static Window* New();
    void DisplayText(const char* words) override {
        if (words && text.size() < max_text) text += words;
    }
    std::string text;
};
vtkStandardNewMacro(Window);

std::mutex one_at_a_time;
vtkSmartPointer<vtkOutputWindow> previous;
vtkSmartPointer<Window> current;
vtkLogger::Verbosity previous_verbosity;

}  // namespace

VtkMessages::VtkMessages() {
    one_at_a_time.lock();
    previous = vtkOutputWindow::GetInstance();
    current = vtkSmartPointer<Window>::New();
    vtkOutputWindow::SetInstance(current);
    // the logger prints to stderr by itself
    previous_verbosity = vtkLogger::GetCurrentVerbosityCutoff();
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkMessages::~VtkMessages() {
    vtkLogger::SetStderrVerbosity(previous_verbosity);
    vtkOutputWindow::SetInstance(previous);
    previous = nullptr;
    current = nullptr;
    one_at_a_time.unlock();
}

bool VtkMessages::any() const { return !current->text.empty(); }

std::string VtkMessages::last() const {
    std::string text = current->text;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    const std::size_t line = text.rfind('\n');
    return line == std::string::npos ? text : text.substr(line + 1);
}

}  // namespace palpate
