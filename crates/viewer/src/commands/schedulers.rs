//! Plans for job schedulers: Slurm and Kubernetes.

use super::Failure;
use crate::cli::quoted_for_posix;
use std::ffi::OsStr;
use std::path::Path;

/// The most tasks of a job array: Slurm's default limit (`MaxArraySize`, 1001). Each task runs every n-th line.
const MAX_TASKS: usize = 1000;

/// The script that submits the plan to Slurm: an array, and another one that waits for it.
pub(super) fn slurm(plan: &Path, jobs: usize, stitching: usize) -> Result<String, Failure> {
    let quoted = |suffix: &str| {
        let mut path = plan.as_os_str().to_owned();
        path.push(suffix);
        quote(&path)
    };
    let run = |suffix: &str, tasks: usize| {
        let pick = format!(
            "awk -v i=\"$SLURM_ARRAY_TASK_ID\" 'NR % {tasks} == i % {tasks}' {}",
            quoted(suffix)?
        );
        Ok::<_, Failure>(format!("#!/bin/sh\n{}", run_lines(&pick)))
    };
    let (tasks, last) = (jobs.clamp(1, MAX_TASKS), stitching.min(MAX_TASKS));
    let log = quoted(".%A-%a.log")?;
    let mut text = format!(
        "#!/bin/sh\n\
         # Submits {jobs} jobs, and the stitching of {stitching} pictures that waits for all of them; options are\n\
         # given to both. A job that a node took with it is put in the queue again.\n\
         set -eu\n\
         jobs=$(sbatch --parsable --requeue --array=1-{tasks} --output={log} \"$@\" <<'JOB'\n{}\nJOB\n)\n\
         echo \"jobs $jobs\"\n",
        run("", tasks)?
    );
    if last > 0 {
        text.push_str(&format!(
            "stitching=$(sbatch --parsable --requeue --dependency=\"afterok:${{jobs%%;*}}\" --kill-on-invalid-dep=yes \\\n    \
             --array=1-{last} --output={log} \"$@\" <<'JOB'\n{}\nJOB\n)\n\
             echo \"stitching $stitching\"\n",
            run(".stitch", last)?
        ));
    }
    Ok(text)
}

/// An Indexed Job: pod i runs line i + 1.
pub(super) fn kubernetes(plan: &Path, suffix: &str, lines: usize) -> Result<String, Failure> {
    let mut path = plan.as_os_str().to_owned();
    path.push(suffix);
    let script = run_lines(&format!(
        "sed -n \"$((JOB_COMPLETION_INDEX + 1))p\" {}",
        quote(&path)?
    ));
    // JSON strings are valid YAML.
    let script = serde_json::to_string(&script)
        .map_err(|error| Failure::could_not(format!("no YAML can be made: {error}")))?;
    let name = if suffix.is_empty() {
        "jobs"
    } else {
        "stitching"
    };
    Ok(format!(
        "# Fill in the image, which holds the program, and the volume with the plan's folders.\n\
         apiVersion: batch/v1\n\
         kind: Job\n\
         metadata:\n  generateName: raycast-{name}-\n\
         spec:\n  \
           completionMode: Indexed\n  \
           completions: {lines}\n  \
           parallelism: {}\n  \
           backoffLimitPerIndex: 3\n  \
           template:\n    \
             spec:\n      \
               restartPolicy: Never\n      \
               containers:\n        \
                 - name: raycast\n          \
                   image: IMAGE\n          \
                   command: [\"sh\", \"-c\", {script}]\n          \
                   volumeMounts:\n            \
                     - name: plan\n              \
                       mountPath: FOLDER\n      \
               volumes:\n        \
                 - name: plan\n          \
                   persistentVolumeClaim:\n            \
                     claimName: CLAIM\n",
        lines.clamp(1, 64)
    ))
}
/// Runs the lines that a command selects from a plan. A pipe alone would return the status of its last command: a
/// plan that cannot be read would succeed.
fn run_lines(pick: &str) -> String {
    format!("lines=$({pick}) && printf '%s\\n' \"$lines\" | sh -e")
}

/// A word quoted for a POSIX shell.
pub(super) fn quote(word: &OsStr) -> Result<String, Failure> {
    let text = word
        .to_str()
        .filter(|text| !text.contains('\n'))
        .ok_or_else(|| {
            Failure::usage(format!(
                "{}: a plan's names are Unicode, and of one line",
                word.display()
            ))
        })?;
    Ok(quoted_for_posix(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_two_lines_is_refused() {
        assert!(quote(OsStr::new("two\nlines")).is_err());
        assert_eq!(
            quote(OsStr::new("it's")).expect("it is Unicode"),
            "'it'\\''s'"
        );
    }
}
